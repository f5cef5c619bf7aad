#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn {

/// Number of single-character insertions, deletions, replacements and swaps of neighbours between two words, letter
/// case ignored (optimal string alignment distance).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate that a user most likely meant by `word`, or empty when none is close (more than a third of the letters
/// differ). Among equals the first candidate wins.
[[nodiscard]] std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// " (did you mean 'x'?)" when there is a close candidate, otherwise " (known: a, b, c)" with at most `limit` names.
[[nodiscard]] std::string suggestion(std::string_view word, std::span<const std::string> candidates,
                                     std::size_t limit = 24);

}  // namespace veridyn
