#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "veridyn/io/log/log.hpp"
#include "veridyn/io/tables/table_options.hpp"

namespace veridyn::io {

/// Whether the bytes start as a MAT file of level 5 (MATLAB 5 to 7.2) or of MATLAB 7.3.
[[nodiscard]] bool is_mat(std::string_view bytes);

/// Reads a MATLAB file: series become topics, everything else is kept as tables.
///
/// - A struct, or the file itself, that holds a vector with a name by which stamps are known (time, t, TimeMS, ...), or
///   which the options name, makes a topic of all its numeric vectors of that length (`flight_data.p`); a matrix with
///   as many rows gives one field a column, `q[0]`. Structs may lie in structs (`a.b.x`).
/// - A matrix X with a cell array X_label of column names is one message of an ArduPilot log as its ground stations
///   export it; units come from the table of known messages.
/// - Where the options give names of columns, the matrix with as many columns, or the one that they name, is a table of
///   them; the stamps are one of these, or made from a rate. With a rate alone, the arrays with the most rows are the
///   series. SIDPAC's `fdata` needs no names. Of a matrix of rows x columns x segments one segment is read.
/// - Other numeric arrays become fields of a topic without time, with their `shape`; texts become information. Where no
///   series was found, a note says what the file holds.
/// - Tables and timetables of level 5 files are structs of their columns of numbers (`MatObjects`); for each other
/// object
///   a note says how to save it.
/// Level 5 files are read by our own checked code; those of MATLAB 7.3 by matio and HDF5, whose behaviour on damaged
/// files is theirs. Complex numbers lose their imaginary part; sparse matrices and other objects are left out.
/// @throws InputError when it is not such a file, and where the options name what it does not hold. A damaged variable
/// does not throw; it is counted.
[[nodiscard]] Log read_mat(std::string_view bytes, std::string source, const TableOptions& options = {});

/// @throws InputError also when the file is missing, a directory, or empty.
[[nodiscard]] Log read_mat_file(const std::filesystem::path& path, const TableOptions& options = {});

}  // namespace veridyn::io
