#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/cueing/platform/platform.hpp"

namespace veridyn::cueing {

/// All that `[platform]` says of a platform, as keys and values of TOML: what `Platform::read` reads back to the same
/// numbers, without a built-in one or a file.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> platform_keys(const Platform& platform);
/// A file of it, with the table `[platform]`. @param comment its first lines, without "# "
[[nodiscard]] std::string platform_file(const Platform& platform, const std::string& comment);
/// From such a file. @throws InputError with file, line and key; for one that names a further file
[[nodiscard]] Platform read_platform_file(const std::filesystem::path& path);

}  // namespace veridyn::cueing
