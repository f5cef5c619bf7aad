#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// OpenSim's storage format (.sto, and .mot for motions): a name, header lines `key=value`, `endheader`, a row of
/// labels of which the first is `time`, rows of numbers separated by blanks or tabulators.
///
/// The numbers are as in the file. `inDegrees=yes` says that rotations, and only they, are in degrees; which columns
/// are rotations only a model knows.
struct Storage {
  std::string source;  ///< file name, for messages
  std::string name;    ///< first line of the file
  bool in_degrees = false;
  std::vector<std::string> labels;  ///< without the time
  std::vector<double> time;         ///< [s], strictly increasing
  std::vector<double> values;       ///< time.size() x labels.size(), row after row

  [[nodiscard]] std::size_t rows() const { return time.size(); }
  [[nodiscard]] std::size_t columns() const { return labels.size(); }
  [[nodiscard]] double value(std::size_t row, std::size_t column) const { return values[row * columns() + column]; }
  [[nodiscard]] std::vector<double> column(std::size_t index) const;
};

/// Whether this is text with an `endheader` line near its beginning.
[[nodiscard]] bool is_storage(std::string_view bytes);

/// Parses the text of a storage file.
/// @throws InputError with file:line: no endheader, no time column, labels twice, rows of another length, cells that
/// are not finite numbers, time that does not increase, no rows, counts in the header that the file does not keep.
[[nodiscard]] Storage parse_storage(std::string_view text, std::string source);

/// As text that OpenSim reads; numbers read back to the same double.
[[nodiscard]] std::string to_storage_text(const Storage& storage);
/// Writes `to_storage_text`, whole or not at all.
void write_storage(const Storage& storage, const std::filesystem::path& path);

/// The same as a log of one topic, for those who read any format.
[[nodiscard]] Log read_storage_log(std::string_view bytes, std::string source);

}  // namespace veridyn::io
