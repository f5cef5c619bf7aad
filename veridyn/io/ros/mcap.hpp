#pragma once

#include <string>
#include <string_view>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

namespace internal {
class RosLog;
/// The messages of one more file of a recording; damage goes into `log`.
void add_mcap(std::string_view bytes, RosLog& messages, Log& log);
}  // namespace internal

/// Whether the bytes start as an MCAP recording.
[[nodiscard]] bool is_mcap(std::string_view bytes);

/// Reads an MCAP recording (version 0) of messages of ROS 2 (`cdr`, little or big endian) or ROS 1 (`ros1`), by the
/// definitions that it holds (`ros2msg`, `ros1msg`), or else those of standard messages. Every number of a message is a
/// field of its topic (`internal::RosLog`), named without the slash ahead: `imu/data`, `linear_acceleration.x`.
///
/// - Chunks may be compressed by lz4 or zstd, up to 256 MiB each; one with a wrong checksum is left out and counted.
///   Summary and indices are not needed: a recording that was cut off is read as far as it goes, its last chunk too.
///   After damage the reader goes on at the next records that follow each other.
/// - Times are the messages' own (`header.stamp`), on the clock by which they were logged, from when the first message
///   was logged; those without a stamp have the time at which they were logged.
/// - Messages in other encodings (protobuf, JSON) are named in the notes.
/// @throws InputError when it is none, or no message can be decoded.
[[nodiscard]] Log read_mcap(std::string_view bytes, std::string source);

}  // namespace veridyn::io
