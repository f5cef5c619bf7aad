#pragma once

#include <string>
#include <string_view>

#include "veridyn/core/units.hpp"

namespace veridyn {

/// A unit as people write it, in the words of NIST SP 811 that `parse_unit` has: "degrees/sec" -> "deg/s", "KIAS" ->
/// "kt", "m/s²" -> "m/s^2", "°C" -> "degC", "ft-lbs" -> "ft lbf", "slug-ft2" -> "slug.ft2"; UTF-8 and Latin-1. Words
/// that are not known stay as they are. Does not throw.
[[nodiscard]] std::string in_standard_words(std::string_view text);

/// Of a text with two meanings the unit of the expected dimension: "G" is gravity of an acceleration and gauss of a
/// magnetic field, "lb" a force of a thrust and a mass of a body. Any other text as it is.
[[nodiscard]] std::string unit_meant(std::string_view text, const Unit& expected);

}  // namespace veridyn
