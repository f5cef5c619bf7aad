#pragma once

#include <cstdio>
#include <string>

namespace veridyn {

/// Text for people on stderr. Never throws: where nobody can read it, it is lost.
inline void print_to_stderr(const std::string& text) noexcept {
  // Not fmt::print, which throws where stderr cannot be written.
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
}

}  // namespace veridyn
