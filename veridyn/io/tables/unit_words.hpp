#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace veridyn::io {

/// A unit as people write it into the header of a table, in the words of `parse_unit`: "degrees/sec" -> "deg/s",
/// "knots" -> "kt", "m/s²" -> "m/s^2", "°C" -> "degC", "g's" -> "g"; UTF-8 and Latin-1. Empty for what is no unit, and
/// for words with two meanings ("rps": radians or revolutions). Does not throw.
[[nodiscard]] std::optional<std::string> unit_in_words(std::string_view text);

/// The unit of the numbers of a column of this name, in a file by others. "G" is gravity there, unless the name is that
/// of a compass ("Mag X [G]").
[[nodiscard]] std::optional<std::string> unit_of_column(std::string_view text, std::string_view name);

}  // namespace veridyn::io
