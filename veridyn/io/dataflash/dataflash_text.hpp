#pragma once

#include <string>
#include <string_view>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// Whether the first 64 KiB hold a line that starts with "FMT,".
[[nodiscard]] bool is_dataflash_text(std::string_view bytes);

/// Reads the text form of an ArduPilot log (.log), of old firmware and of today's ground stations.
///
/// Lines are `NAME, value, value, ...` with the columns that the FMT lines name; numbers are scaled already. Free lines
/// ahead of the first FMT, blank lines, FMT lines with fewer columns, empty formats and NaN are no damage. A line of an
/// undefined message, with too few cells, or with a non-numeric cell where the format has a number, is left out and
/// counted. Texts may hold commas. Units and instances as in `read_dataflash`.
/// @throws InputError when there is no FMT line.
[[nodiscard]] Log read_dataflash_text(std::string_view bytes, std::string source);

}  // namespace veridyn::io
