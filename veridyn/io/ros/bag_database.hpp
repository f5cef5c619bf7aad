#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

namespace internal {
class RosLog;
/// The messages of one more file of a recording; damage goes into `log`. @throws InputError when it is no bag.
void add_bag_database(const std::filesystem::path& path, RosLog& messages, Log& log);
}  // namespace internal

/// Whether the bytes start as a database of SQLite.
[[nodiscard]] bool is_sqlite(std::string_view bytes);

/// Reads a bag of ROS 2 as rosbag2 writes it into a database of SQLite (.db3): tables `topics` and `messages`, and
/// since ROS 2 Iron `message_definitions`. Older bags do not hold the definitions of their messages: those of standard
/// messages are known (`internal::find_standard_message`), other topics are named in the notes. Messages may be
/// compressed one by one (zstd). All else as of `read_mcap`.
/// @throws InputError when it is none, damaged beyond reading, or no message can be decoded.
[[nodiscard]] Log read_bag_database(const std::filesystem::path& path);
/// From memory.
[[nodiscard]] Log read_bag_database(std::string_view bytes, std::string source);

}  // namespace veridyn::io
