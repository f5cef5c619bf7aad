#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn::internal {

/// A text that a template leaves to its user, `mass = "? kg"`.
struct Placeholder {
  std::uint32_t line = 0;
  std::string name;  ///< dotted key
};

/// Whether a value of a study is one.
template <typename Node>
[[nodiscard]] bool is_placeholder(const Node& node) {
  const auto* text = node.as_string();
  return text != nullptr && text->get().starts_with('?');
}

/// Adds all within a value of a study. The type of the value is the TOML library's, which headers do not name.
template <typename Node>
void find_placeholders(const Node& node, const std::string& path, std::vector<Placeholder>& found) {
  if (const auto* table = node.as_table()) {
    for (const auto& [key, value] : *table)
      find_placeholders(value, path.empty() ? std::string(key.str()) : path + '.' + std::string(key.str()), found);
  } else if (const auto* array = node.as_array()) {
    for (const auto& item : *array) find_placeholders(item, path, found);
  } else if (is_placeholder(node)) {
    found.push_back({node.source().begin.line, path});
  }
}

/// Why `text` in this line is refused, with all others that a study still has: "is still the template's placeholder, as
/// are subject.span (line 14), ...: put in your own values".
[[nodiscard]] std::string placeholder_refusal(std::string_view text, std::uint32_t line, std::vector<Placeholder> all);

}  // namespace veridyn::internal
