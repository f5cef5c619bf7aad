#pragma once

#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// What an aircraft's identification reports, with made-up numbers (fixed seed): every kind of block, gaps, one hour of
/// samples in one of the figures, and strings that try to break the page.
[[nodiscard]] Document sample_document();

/// The string in it that must never be interpreted.
inline constexpr const char* kHostileText = "</script><img src=x onerror=\"window.broken=1\"><!-- \xE2\x80\xA8 & ' \"";

}  // namespace veridyn::report
