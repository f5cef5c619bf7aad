#pragma once

#include <string>

#include "veridyn/report/document/document.hpp"
#include "veridyn/report/document/json.hpp"

namespace veridyn::report {

/// The report as one HTML page that needs nothing else: no network, no fonts, no other file. Readable without a script
/// (verdict, facts, texts, tables); with one, figures with linked zoom, sorting, light and dark colours, and paper.
/// Built without the front end (CMake option VERIDYN_WEB=OFF) the page has no script and says that figures need it.
/// A caption that several blocks have is at the first.
[[nodiscard]] std::string to_html(Document all, const JsonOptions& options = {});

}  // namespace veridyn::report
