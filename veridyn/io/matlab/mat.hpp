#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// Whether the bytes start as a MAT file of level 5 (MATLAB 5 to 7.2) or of MATLAB 7.3.
[[nodiscard]] bool is_mat(std::string_view bytes);

/// Reads a MATLAB file: series become topics, everything else is kept as tables.
///
/// - A struct, or the file itself, that holds a vector named time, t, Time (s), TimeMS or TimeUS makes a topic of all
///   its numeric vectors of that length (`flight_data.p`); a matrix with as many rows gives one field a column,
///   `q[0]`. Structs may lie in structs (`a.b.x`).
/// - A matrix X with a cell array X_label of column names is one message of an ArduPilot log as its ground stations
///   export it; units come from the table of known messages.
/// - Other numeric arrays become fields of a topic without time, with their `shape`; texts become information.
/// Level 5 files are read by our own checked code; those of MATLAB 7.3 by matio and HDF5, whose behaviour on damaged
/// files is theirs. Complex numbers lose their imaginary part; sparse matrices and objects are left out.
/// @throws InputError when it is not such a file. A damaged variable does not throw; it is counted.
[[nodiscard]] Log read_mat(std::string_view bytes, std::string source);

/// @throws InputError also when the file is missing, a directory, or empty.
[[nodiscard]] Log read_mat_file(const std::filesystem::path& path);

}  // namespace veridyn::io
