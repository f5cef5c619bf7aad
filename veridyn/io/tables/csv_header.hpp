#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/tables/csv.hpp"

namespace veridyn::io::internal {

/// The name of a column and its unit.
struct Header {
  std::string name;
  std::string unit;  ///< empty: none given
};

/// `name[unit]` in its parts. In files by others "control[3]" is an element and brackets that hold no unit are part of
/// the name; in ours (`our_own`) the last brackets always hold a unit.
/// @throws InputError for an unknown unit in a file of ours
[[nodiscard]] Header split_header(const std::string& cell, bool our_own, const std::string& place);

/// Where the stamps of a file are and what they are.
struct TimeChoice {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t column = kNone;  ///< none: stamps are made from a rate
  double scale = 1.0;          ///< to seconds
  bool dates = false;
};

/// Chooses as read_csv describes. @param first_row of the data, which tells dates and the unit of `timestamp`
/// @throws InputError where there is no time column, the options name one that is not there, or its unit is no time
[[nodiscard]] TimeChoice choose_time(const std::vector<Header>& headers, const CsvOptions& options,
                                     std::string_view first_row, char delimiter, const std::string& place);

}  // namespace veridyn::io::internal
