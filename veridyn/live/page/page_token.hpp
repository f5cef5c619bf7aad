#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "veridyn/live/link/datagram.hpp"

namespace veridyn::live {

/// A token of 128 random bits, in hexadecimal.
[[nodiscard]] std::string random_token();

/// The first line of a file. @throws InputError where it cannot be read, others than its owner can read it, or the
/// token has fewer than 16 characters.
[[nodiscard]] std::string read_token_file(const std::filesystem::path& path);

/// Who may control a page.
struct PageAccess {
  std::string token;  ///< empty: nobody
  std::string said;   ///< to whoever starts the program: a token that was drawn
};
/// The token of a file; where none is named, one that is drawn on loopback, and none on a page that other machines
/// reach. @throws InputError as `read_token_file`
[[nodiscard]] PageAccess page_access(const Sender& address, const std::filesystem::path& token_file);

/// In a time that does not tell where they differ.
[[nodiscard]] bool equal_in_constant_time(std::string_view a, std::string_view b);

}  // namespace veridyn::live
