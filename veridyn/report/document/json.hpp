#pragma once

#include <cstddef>
#include <string>

#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// How finely lines and bands are drawn.
struct JsonOptions {
  /// Most points of a line: twice the pixels of a wide screen, so that nothing is lost before zooming in.
  std::size_t points_per_line = 4000;
  /// Most points of a band, which is smoother than its line.
  std::size_t points_per_band = 1500;
};

/// The document for the front end (types in web/src/document.ts): lines decimated (the figure's footnote says so),
/// samples rounded to a 1/20 000 of their range, NaN as null.
///
/// Plain ASCII, and free of '<', '>' and '&' (written as `\u003c` ...), so that it can stand in a `<script>` element
/// whatever the texts hold. Bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string to_json(const Document& document, const JsonOptions& options = {});

}  // namespace veridyn::report
