#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/log/column.hpp"
#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// An array of a NumPy file, column by column in its own type (bool as 0 and 1).
struct NpyArray {
  std::string type;                ///< as in the file, "<f8"
  std::vector<std::size_t> shape;  ///< one extent or two
  std::vector<Column> columns;     ///< one for a vector, else `shape[1]`

  [[nodiscard]] std::size_t rows() const { return shape.empty() ? 0 : shape.front(); }
};

/// Whether bytes start as a NumPy array file does.
[[nodiscard]] bool is_npy(std::string_view bytes);

/// Reads a NumPy array, format versions 1 to 3 (numpy.lib.format): little-endian float64, float32, signed and unsigned
/// integers of 1 to 8 bytes and bool, in C or Fortran order, of one or two dimensions.
/// @throws InputError naming the source and what is not supported or broken: other types (objects, which are Python
/// programs, are refused like the rest), other dimensions, a header that is no such dictionary, fewer or more bytes
/// than the shape needs.
[[nodiscard]] NpyArray read_npy(std::string_view bytes, const std::string& source);

/// Reads a folder of NumPy arrays, with the folders in it, as a log. What belongs together:
///
/// - `t.npy` [s] and `value.npy` in one folder: the message of that folder's path, less the folders that all such pairs
///   share: `processed_log/IMU/gyro/{t,value}.npy` gives the channels `IMU.gyro[0]`, `IMU.gyro[1]`, ... beside a
///   `CAN.speed`;
/// - `NAME_times.npy` [s] and `NAME_*.npy` with as many rows: `global_pose/frame_{times,positions}.npy` gives
///   `global_pose.frame_positions[0]`, ...
///
/// Every message has its own time base; a vector or a single column has no index. The files do not say units.
/// Arrays that belong to no stamps are named in a note. Stamps are put in order as those of any log.
/// @throws InputError when the folder cannot be read, holds no such arrays or too much (over 10 000 entries, eight
/// levels), when values and stamps differ in number, or as `read_npy`.
[[nodiscard]] Log read_npy_folder(const std::filesystem::path& folder);

}  // namespace veridyn::io
