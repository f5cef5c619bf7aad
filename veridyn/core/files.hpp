#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace veridyn {

/// The whole of a file.
/// @throws InputError when it is missing, a directory, or cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// Writes a file so that at every moment either the old or the whole new content stands under its name: a temporary
/// file alongside it, then a rename. The old content is untouched when it throws.
/// @param shown  what messages call the file; empty: its path
/// @throws InputError when the folder is missing or not writable; std::runtime_error when the disk is full, a quota or
/// limit of size is reached, or the device fails: the choice of the file was not wrong.
void write_file(const std::filesystem::path& path, std::string_view content, std::string_view shown = {});

/// Makes a folder with its parents.
/// @throws InputError when something that is no folder stands in the way or it cannot be made.
void make_folder(const std::filesystem::path& path);

}  // namespace veridyn
