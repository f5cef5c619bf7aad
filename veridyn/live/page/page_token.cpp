#include "veridyn/live/page/page_token.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <random>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/text.hpp"

namespace veridyn::live {

std::string random_token() {
  std::random_device random;
  std::string token;
  for (int k = 0; k < 4; ++k) token += fmt::format("{:08x}", static_cast<std::uint32_t>(random()));
  return token;
}

std::string read_token_file(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  struct stat status {};
  constexpr mode_t kOthers = 077;
  if (::stat(path.c_str(), &status) == 0 && (status.st_mode & kOthers) != 0)
    throw InputError(path.string(), "can be read by others: it is a secret (chmod 600)");
  std::string token(trimmed(std::string_view(text).substr(0, text.find('\n'))));
  constexpr std::size_t kShortest = 16;
  if (token.size() < kShortest)
    throw InputError(path.string(),
                     fmt::format("holds a token of {} characters; takes {} at least", token.size(), kShortest));
  return token;
}

PageAccess page_access(const Sender& address, const std::filesystem::path& token_file) {
  if (!token_file.empty()) return {.token = read_token_file(token_file), .said = ""};
  if (!is_loopback(address)) return {};
  PageAccess access{.token = random_token(), .said = ""};
  access.said = "  token: " + access.token;
  return access;
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  unsigned different = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < b.size(); ++i)
    different |= static_cast<unsigned char>(b[i]) ^ static_cast<unsigned char>(a.empty() ? 0 : a[i % a.size()]);
  return different == 0 && !b.empty();
}

}  // namespace veridyn::live
