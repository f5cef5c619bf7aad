#include "veridyn/core/unit_spellings.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"

namespace veridyn {
namespace {

using Replacement = std::pair<std::string_view, std::string_view>;

/// Signs outside ASCII, as UTF-8 and as the single byte of Latin-1.
constexpr Replacement kSigns[] = {
    {"\xC2\xB0", "deg"}, {"\xC2\xBA", "deg"},   {"\xB0", "deg"},   {"\xC2\xB2", "^2"},      {"\xB2", "^2"},
    {"\xC2\xB3", "^3"},  {"\xB3", "^3"},        {"\xC2\xB5", "u"}, {"\xCE\xBC", "u"},       {"\xB5", "u"},
    {"\xC2\xB7", "."},   {"\xE2\x8B\x85", "."}, {"**", "^"},       {"\xE2\x84\x83", "degC"}};

/// Whole texts, then words, in small letters. Single letters are not among them: "S" may be a side.
constexpr Replacement kWords[] = {{"sec", "s"},           {"secs", "s"},
                                  {"second", "s"},        {"seconds", "s"},
                                  {"msec", "ms"},         {"millisecond", "ms"},
                                  {"milliseconds", "ms"}, {"usec", "us"},
                                  {"microsecond", "us"},  {"microseconds", "us"},
                                  {"nsec", "ns"},         {"nanosecond", "ns"},
                                  {"nanoseconds", "ns"},  {"hr", "h"},
                                  {"hour", "h"},          {"hours", "h"},
                                  {"minute", "min"},      {"minutes", "min"},
                                  {"deg", "deg"},         {"degs", "deg"},
                                  {"degree", "deg"},      {"degrees", "deg"},
                                  {"rad", "rad"},         {"rads", "rad"},
                                  {"radian", "rad"},      {"radians", "rad"},
                                  {"meter", "m"},         {"meters", "m"},
                                  {"metre", "m"},         {"metres", "m"},
                                  {"km", "km"},           {"kilometer", "km"},
                                  {"kilometers", "km"},   {"kilometre", "km"},
                                  {"kilometres", "km"},   {"cm", "cm"},
                                  {"ft", "ft"},           {"foot", "ft"},
                                  {"feet", "ft"},         {"inch", "in"},
                                  {"inches", "in"},       {"mile", "mi"},
                                  {"miles", "mi"},        {"nmi", "nmi"},
                                  {"kt", "kt"},           {"kts", "kt"},
                                  {"knot", "kt"},         {"knots", "kt"},
                                  {"kias", "kt"},         {"kcas", "kt"},
                                  {"keas", "kt"},         {"ktas", "kt"},
                                  {"ktgs", "kt"},         {"mph", "mph"},
                                  {"kph", "kph"},         {"kmh", "km/h"},
                                  {"kmph", "km/h"},       {"mps", "m/s"},
                                  {"fps", "ft/s"},        {"fpm", "ft/min"},
                                  {"dps", "deg/s"},       {"degps", "deg/s"},
                                  {"radps", "rad/s"},     {"gs", "g"},
                                  {"g's", "g"},           {"kg", "kg"},
                                  {"kilogram", "kg"},     {"kilograms", "kg"},
                                  {"lbs", "lb"},          {"pound", "lb"},
                                  {"pounds", "lb"},       {"lbf", "lbf"},
                                  {"slugs", "slug"},      {"newton", "N"},
                                  {"newtons", "N"},       {"pascal", "Pa"},
                                  {"pascals", "Pa"},      {"hpa", "hPa"},
                                  {"kpa", "kPa"},         {"mbar", "mbar"},
                                  {"millibar", "mbar"},   {"psi", "psi"},
                                  {"psf", "psf"},         {"inhg", "inHg"},
                                  {"hz", "Hz"},           {"khz", "kHz"},
                                  {"rpm", "rpm"},         {"volt", "V"},
                                  {"volts", "V"},         {"amp", "A"},
                                  {"amps", "A"},          {"percent", "%"},
                                  {"celsius", "degC"},    {"fahrenheit", "degF"},
                                  {"rankine", "degR"},    {"kelvin", "K"},
                                  {"none", "1"},          {"nd", "1"},
                                  {"unitless", "1"},      {"dimensionless", "1"},
                                  {"n/a", "1"},           {"rev/min", "rpm"},
                                  {"tesla", "T"},         {"m/s", "m/s"},
                                  {"m/s2", "m/s^2"},      {"m/s^2", "m/s^2"},
                                  {"km/h", "km/h"},       {"ft/s", "ft/s"},
                                  {"deg/s", "deg/s"},     {"rad/s", "rad/s"},
                                  {"deg c", "degC"},      {"degrees c", "degC"},
                                  {"deg f", "degF"},      {"degrees f", "degF"},
                                  {"in hg", "inHg"},      {"in. hg", "inHg"},
                                  {"inch hg", "inHg"},    {"ft msl", "ft"},
                                  {"ft agl", "ft"},       {"ft wgs", "ft"},
                                  {"ft baro", "ft"},      {"ftmsl", "ft"},
                                  {"ftagl", "ft"},        {"ft-lb", "ft lbf"},
                                  {"ft-lbs", "ft lbf"},   {"ft-lbf", "ft lbf"},
                                  {"lb-ft", "ft lbf"},    {"lbs-ft", "ft lbf"},
                                  {"lbf-ft", "ft lbf"},   {"in-lb", "in lbf"},
                                  {"in-lbs", "in lbf"}};

/// Texts with two meanings: as `parse_unit` has them, and the other.
constexpr Replacement kOtherMeanings[] = {{"G", "g"}, {"lb", "lbf"}};

bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

std::string with_plain_signs(std::string_view text) {
  std::string plain(text);
  for (const auto& [sign, word] : kSigns) {
    for (std::size_t at = plain.find(sign); at != std::string::npos; at = plain.find(sign, at + word.size()))
      plain.replace(at, sign.size(), word);
  }
  return plain;
}

std::string in_known_word(std::string_view word) {
  const std::string small = lower(word);
  const auto* const found = std::find_if(std::begin(kWords), std::end(kWords),
                                         [&](const Replacement& known) { return known.first == small; });
  return std::string(found == std::end(kWords) ? word : found->second);
}

/// "slug-ft2": a product.
std::string with_plain_products(std::string text) {
  for (std::size_t i = 1; i + 1 < text.size(); ++i)
    if (text[i] == '-' && letter(text[i - 1]) && letter(text[i + 1])) text[i] = '.';
  return text;
}

}  // namespace

std::string in_standard_words(std::string_view text) {
  const std::string whole(trimmed(with_plain_signs(text)));
  std::string known = in_known_word(whole);
  if (known != whole) return known;
  const std::string plain = with_plain_products(std::move(known));
  std::string unit;
  for (std::size_t i = 0; i < plain.size();) {
    std::size_t end = i;
    while (end < plain.size() && letter(plain[end])) ++end;
    unit += end > i ? in_known_word(std::string_view(plain).substr(i, end - i)) : plain.substr(i, 1);
    i = std::max(end, i + 1);
  }
  return unit;
}

std::string unit_meant(std::string_view text, const Unit& expected) {
  const std::string word = in_standard_words(text);
  for (const auto& [first, other] : kOtherMeanings)
    if (word == first && !parse_unit(first).same_dimension(expected) && parse_unit(other).same_dimension(expected))
      return std::string(other);
  return std::string(text);
}

}  // namespace veridyn
