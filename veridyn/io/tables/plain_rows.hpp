#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "veridyn/io/tables/csv_cells.hpp"

namespace veridyn::io::internal {

/// The columns of a large table.
struct PlainColumns {
  std::size_t count = 0;            ///< of a row
  std::optional<std::size_t> time;  ///< the one of the stamps, where there is one
  double time_scale = 1.0;          ///< seconds in a unit of it
};

/// Rows that hold nothing out of the ordinary, read in parts side by side: cells are finite numbers or missing, every
/// row has the same number of them, stamps do not go back. Columns come in the order of the cells, stamps in seconds.
/// Nothing where the rows are few, `threads` is 1 (0: as many as the machine has), or anything else stands there: who
/// reads row by row then says what that is.
[[nodiscard]] std::optional<std::vector<std::vector<double>>> read_plain_rows(std::string_view rows, CellStyle style,
                                                                              const PlainColumns& columns, int threads);

}  // namespace veridyn::io::internal
