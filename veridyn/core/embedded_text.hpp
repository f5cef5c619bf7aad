#pragma once

#include <string_view>

namespace veridyn {

/// A file that is built into the program, so that an installed one needs no other; see `veridyn_embed_texts` in
/// cmake/VeridynBuild.cmake.
struct EmbeddedText {
  std::string_view name;  ///< of the file, without its extension
  std::string_view text;
};

}  // namespace veridyn
