#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace veridyn::live {

/// A token of 128 random bits, in hexadecimal.
[[nodiscard]] std::string random_token();

/// The first line of a file. @throws InputError where it cannot be read, others than its owner can read it, or the
/// token has fewer than 16 characters.
[[nodiscard]] std::string read_token_file(const std::filesystem::path& path);

/// In a time that does not tell where they differ.
[[nodiscard]] bool equal_in_constant_time(std::string_view a, std::string_view b);

}  // namespace veridyn::live
