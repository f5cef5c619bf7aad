#pragma once

#include <span>

#include "veridyn/core/embedded_text.hpp"

namespace veridyn::live {

/// The page itself, from live_page.html.
[[nodiscard]] std::span<const EmbeddedText> page_texts();

}  // namespace veridyn::live
