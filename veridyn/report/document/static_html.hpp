#pragma once

#include <string>
#include <string_view>

#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// Text for HTML: &, <, > and both quotes as entities.
[[nodiscard]] std::string escape_html(std::string_view text);

/// The report as HTML without a script: title, verdict, facts, texts and tables; figures by title and caption with a
/// note that their picture needs the front end. Stands in the page until the script runs, and for readers without one.
/// Element names and classes are those of web/src/blocks.ts, so one style sheet serves both.
[[nodiscard]] std::string static_html(const Document& document, std::string_view note_for_figures);

}  // namespace veridyn::report
