#pragma once

#include <string>
#include <string_view>

namespace veridyn {

/// Without blanks, tabulators and line ends at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// ASCII letters as capitals.
[[nodiscard]] std::string upper(std::string_view text);
/// ASCII letters as small letters.
[[nodiscard]] std::string lower(std::string_view text);

/// With a capital at its beginning, where that is an ASCII letter.
[[nodiscard]] std::string capitalised(std::string text);

/// Bytes of a file for a message: at most 40, what is not printable as '?'.
[[nodiscard]] std::string shown(std::string_view text);

/// As a string of TOML, in quotes.
[[nodiscard]] std::string toml_text(std::string_view text);

}  // namespace veridyn
