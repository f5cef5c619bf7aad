#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

namespace internal {
/// The names below `relative_file_paths` of a bag's metadata.yaml, in their order.
[[nodiscard]] std::vector<std::string> bag_files(std::string_view metadata);
}  // namespace internal

/// Whether a folder is a bag of ROS 2: it holds metadata.yaml, and files .mcap or .db3.
[[nodiscard]] bool is_bag_folder(const std::filesystem::path& folder);

/// Reads a bag of ROS 2, a folder as `ros2 bag record` makes it, as one recording: the files that its metadata.yaml
/// lists, or where it lists none all .mcap and .db3 in the order of their numbers. Files that are missing or cannot be
/// read are noted.
/// @throws InputError when none can be read: why the first cannot.
[[nodiscard]] Log read_bag_folder(const std::filesystem::path& folder);

}  // namespace veridyn::io
