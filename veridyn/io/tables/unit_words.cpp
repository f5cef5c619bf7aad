#include "veridyn/io/tables/unit_words.hpp"

#include <algorithm>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/core/units.hpp"

namespace veridyn::io {
namespace {

using Replacement = std::pair<std::string_view, std::string_view>;

/// Signs outside ASCII, as UTF-8 and as the single byte of Latin-1.
constexpr Replacement kSigns[] = {
    {"\xC2\xB0", "deg"}, {"\xC2\xBA", "deg"},   {"\xB0", "deg"},   {"\xC2\xB2", "^2"},      {"\xB2", "^2"},
    {"\xC2\xB3", "^3"},  {"\xB3", "^3"},        {"\xC2\xB5", "u"}, {"\xCE\xBC", "u"},       {"\xB5", "u"},
    {"\xC2\xB7", "."},   {"\xE2\x8B\x85", "."}, {"**", "^"},       {"\xE2\x84\x83", "degC"}};

/// Words in small letters.
constexpr Replacement kWords[] = {
    {"sec", "s"},          {"secs", "s"},          {"second", "s"},       {"seconds", "s"},      {"msec", "ms"},
    {"millisecond", "ms"}, {"milliseconds", "ms"}, {"usec", "us"},        {"microsecond", "us"}, {"microseconds", "us"},
    {"nsec", "ns"},        {"nanosecond", "ns"},   {"nanoseconds", "ns"}, {"hr", "h"},           {"hour", "h"},
    {"hours", "h"},        {"minute", "min"},      {"minutes", "min"},    {"degs", "deg"},       {"degree", "deg"},
    {"degrees", "deg"},    {"rads", "rad"},        {"radian", "rad"},     {"radians", "rad"},    {"meter", "m"},
    {"meters", "m"},       {"metre", "m"},         {"metres", "m"},       {"foot", "ft"},        {"feet", "ft"},
    {"knot", "kt"},        {"knots", "kt"},        {"kts", "kt"},         {"kmh", "km/h"},       {"kmph", "km/h"},
    {"mps", "m/s"},        {"fps", "ft/s"},        {"dps", "deg/s"},      {"degps", "deg/s"},    {"radps", "rad/s"},
    {"gs", "g"},           {"g's", "g"},           {"lbs", "lb"},         {"newton", "N"},       {"newtons", "N"},
    {"pascal", "Pa"},      {"pascals", "Pa"},      {"volt", "V"},         {"volts", "V"},        {"amp", "A"},
    {"amps", "A"},         {"percent", "%"},       {"celsius", "degC"},   {"kelvin", "K"},       {"none", "1"},
    {"nd", "1"},           {"unitless", "1"},      {"n/a", "1"},          {"rev/min", "rpm"},    {"tesla", "T"},
    {"dimensionless", "1"}};

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

}  // namespace

std::optional<std::string> unit_in_words(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  const std::string plain = in_known_word(trimmed(with_plain_signs(text.substr(0, kLongest + 1))));
  if (plain.empty() || plain.size() > kLongest) return std::nullopt;
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  std::string unit;
  for (std::size_t i = 0; i < plain.size();) {
    std::size_t end = i;
    while (end < plain.size() && letter(plain[end])) ++end;
    unit += end > i ? in_known_word(std::string_view(plain).substr(i, end - i)) : plain.substr(i, 1);
    i = std::max(end, i + 1);
  }
  try {
    static_cast<void>(parse_unit(unit));
  } catch (const InputError&) {
    return std::nullopt;
  }
  return unit;
}

}  // namespace veridyn::io
