#pragma once

#include <string>
#include <string_view>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// Whether the bytes look like an ArduPilot DataFlash log: a record header at the start, or a FMT record in the first
/// 64 KiB.
[[nodiscard]] bool is_dataflash(std::string_view bytes);

/// Reads an ArduPilot DataFlash log (.bin): every message type, column by column.
///
/// Format: ardupilot.org/dev/docs/code-overview-adding-a-new-log-message.html and libraries/AP_Logger/LogStructure.h.
/// - Records advance by the length in their FMT, whatever the sum of the format characters is; what does not fit the
///   length is left out. Formats that stand after the first records of their type are found and used.
/// - After damage the reader goes on at the next header that is followed by another one, or by the end. Bytes between
///   are counted as lost, each stretch as at least one record.
/// - Units come from FMTU, UNIT and MULT, otherwise from a table of the standard messages. Columns marked '#' split a
///   message into instances.
/// - Times: see `order_stamps`; messages without a stamp take that of the record before them. Where the clock restarts
///   (files of several flights) they go on (`ClockRestarts`).
/// Cost: one pass over the file for the index and one for the columns; memory about the size of the file. No record
/// throws.
/// @throws InputError when there is not one FMT record in the bytes.
[[nodiscard]] Log read_dataflash(std::string_view bytes, std::string source);

}  // namespace veridyn::io
