#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace veridyn::io::internal {

/// Rows [begin, end) of a table between restarts of its clock.
struct ClockPart {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Fewest rows of a part: where stamps go back more often, rows are out of order, and no clock restarts.
inline constexpr std::size_t kShortestPart = 10;

/// The parts of a table of `rows` rows whose stamps go back at the rows `restarts`; empty where these are too close for
/// a clock that restarts.
[[nodiscard]] std::vector<ClockPart> clock_parts(std::span<const std::size_t> restarts, std::size_t rows);

/// The part that `chosen` numbers from 1, or the longest in time (0).
/// @throws InputError at `source` where there are fewer
[[nodiscard]] std::size_t choose_part(std::span<const ClockPart> parts, std::span<const double> stamps,
                                      std::size_t chosen, const std::string& source);

/// "the clock restarts: part 1 (rows 1 to 120, 0 s to 2.4 s), part 2 (...); part 1 is read, `part = 2` in [data] ..."
[[nodiscard]] std::string parts_in_words(std::span<const ClockPart> parts, std::span<const double> stamps,
                                         std::size_t read);

}  // namespace veridyn::io::internal
