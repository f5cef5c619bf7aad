#include "veridyn/io/tables/unit_words.hpp"

#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/core/unit_spellings.hpp"
#include "veridyn/core/units.hpp"

namespace veridyn::io {
namespace {

/// Whether numbers of a column of this name are a magnetic field.
bool names_a_compass(std::string_view name) {
  const std::string small = lower(name);
  return small.find("mag") != std::string::npos || small.find("compass") != std::string::npos ||
         small.find("field") != std::string::npos;
}

}  // namespace

std::optional<std::string> unit_in_words(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  text = trimmed(text);
  if (text.empty() || text.size() > kLongest) return std::nullopt;
  try {
    static_cast<void>(parse_unit(text));
    std::string unit = in_standard_words(text);
    static_cast<void>(parse_unit(unit));
    return unit;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::optional<std::string> unit_of_column(std::string_view text, std::string_view name) {
  auto unit = unit_in_words(text);
  if (unit == "G" && !names_a_compass(name)) return "g";
  return unit;
}

}  // namespace veridyn::io
