#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace veridyn {

/// The whole of a file.
/// @throws InputError when it is missing, a directory, or cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// Writes a file so that at every moment either the old or the whole new content stands under its name: a temporary
/// file beside it, then a rename.
/// @throws InputError when the folder is missing or not writable, or the disk is full; the old content is then
/// untouched.
void write_file(const std::filesystem::path& path, std::string_view content);

/// Makes a folder with its parents.
/// @throws InputError when something that is no folder stands in the way or it cannot be made.
void make_folder(const std::filesystem::path& path);

}  // namespace veridyn
