#pragma once

#include <string>
#include <string_view>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// Whether the bytes start as a PX4 ULog: 55 4C 6F 67 01 12 35.
[[nodiscard]] bool is_ulog(std::string_view bytes);

/// Reads a PX4 ULog (.ulg): every topic and instance, column by column.
///
/// Format: docs.px4.io/main/en/dev_log/ulog_file_format. All message types: flag bits with appended data, formats
/// (nested, arrays as `control[0]`, nested arrays as `esc[0].esc_rpm`, padding left out), information and its continued
/// form, parameters and their defaults, subscriptions, data, logged and tagged texts, sync, dropouts. Unknown types are
/// skipped.
/// - Formats may stand after the data they describe. Data messages that are too short for their format, or of an id
///   that were not subscribed, are left out and counted; longer ones are cut.
/// - After damage the reader goes on where several sound messages follow each other.
/// - ULog holds no units: see `px4_unit`.
/// - Logs one after the other in a file, each with its header, are one: topics that they have alike go on.
/// Times are `timestamp` [s] since the autopilot started; see `order_stamps`, and `ClockRestarts` where it starts
/// again.
/// @throws InputError when the magic is missing, the header is cut, or an incompatible flag is set that this reader
/// does not know (every bit but that of appended data).
[[nodiscard]] Log read_ulog(std::string_view bytes, std::string source);

}  // namespace veridyn::io
