#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace veridyn::io {

/// A text as a cell of our own CSV files: in quotes where it holds a comma, a quote or a line break.
[[nodiscard]] inline std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
  return cell + "\"";
}

/// A number as a cell; empty where there is none.
[[nodiscard]] inline std::string csv_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string();
}

}  // namespace veridyn::io
