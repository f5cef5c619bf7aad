#include "veridyn/core/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/unit_spellings.hpp"

namespace veridyn {
namespace {

using Dimension = std::array<int, Unit::kDimensions>;

constexpr Dimension kNone{};
constexpr Dimension kLength{1, 0, 0, 0, 0, 0};
constexpr Dimension kMass{0, 1, 0, 0, 0, 0};
constexpr Dimension kTime{0, 0, 1, 0, 0, 0};
constexpr Dimension kTemperature{0, 0, 0, 1, 0, 0};
constexpr Dimension kCurrent{0, 0, 0, 0, 1, 0};
constexpr Dimension kAngle{0, 0, 0, 0, 0, 1};
constexpr Dimension kSpeed{1, 0, -1, 0, 0, 0};
constexpr Dimension kAcceleration{1, 0, -2, 0, 0, 0};
constexpr Dimension kRate{0, 0, -1, 0, 0, 1};
constexpr Dimension kFrequency{0, 0, -1, 0, 0, 0};
constexpr Dimension kForce{1, 1, -2, 0, 0, 0};
constexpr Dimension kPressure{-1, 1, -2, 0, 0, 0};
constexpr Dimension kEnergy{2, 1, -2, 0, 0, 0};
constexpr Dimension kPower{2, 1, -3, 0, 0, 0};
constexpr Dimension kVoltage{2, 1, -3, 0, -1, 0};
constexpr Dimension kMagneticField{0, 1, -2, 0, -1, 0};

struct NamedUnit {
  Dimension dimension;
  double scale;
  double offset = 0.0;
};

// Exact by definition (NIST SP 811) but for the rounding of double.
const std::map<std::string, NamedUnit, std::less<>>& known_units() {
  constexpr double kPoundForce = 0.45359237 * kGravity;
  static const std::map<std::string, NamedUnit, std::less<>> units{
      {"m", {kLength, 1.0}},
      {"km", {kLength, 1e3}},
      {"cm", {kLength, 1e-2}},
      {"mm", {kLength, 1e-3}},
      {"ft", {kLength, 0.3048}},
      {"in", {kLength, 0.0254}},
      {"nmi", {kLength, 1852.0}},
      {"mi", {kLength, 1609.344}},
      {"kg", {kMass, 1.0}},
      {"gram", {kMass, 1e-3}},
      {"lb", {kMass, 0.45359237}},
      {"slug", {kMass, kPoundForce / 0.3048}},
      {"s", {kTime, 1.0}},
      {"ms", {kTime, 1e-3}},
      {"us", {kTime, 1e-6}},
      {"ns", {kTime, 1e-9}},
      {"min", {kTime, 60.0}},
      {"h", {kTime, 3600.0}},
      {"K", {kTemperature, 1.0}},
      {"degC", {kTemperature, 1.0, 273.15}},
      {"degF", {kTemperature, 5.0 / 9.0, 459.67 * 5.0 / 9.0}},
      {"degR", {kTemperature, 5.0 / 9.0}},
      {"A", {kCurrent, 1.0}},
      {"mA", {kCurrent, 1e-3}},
      {"rad", {kAngle, 1.0}},
      {"mrad", {kAngle, 1e-3}},
      {"deg", {kAngle, kDegree}},
      {"rev", {kAngle, kFullTurn}},
      {"rpm", {kRate, kFullTurn / 60.0}},
      {"Hz", {kFrequency, 1.0}},
      {"kHz", {kFrequency, 1e3}},
      {"kt", {kSpeed, 1852.0 / 3600.0}},
      {"mph", {kSpeed, 0.44704}},
      {"kph", {kSpeed, 1.0 / 3.6}},
      {"g", {kAcceleration, kGravity}},
      {"g0", {kAcceleration, kGravity}},
      {"N", {kForce, 1.0}},
      {"kN", {kForce, 1e3}},
      {"lbf", {kForce, kPoundForce}},
      {"Pa", {kPressure, 1.0}},
      {"hPa", {kPressure, 1e2}},
      {"kPa", {kPressure, 1e3}},
      {"bar", {kPressure, 1e5}},
      {"mbar", {kPressure, 1e2}},
      {"psi", {kPressure, kPoundForce / (0.0254 * 0.0254)}},
      {"psf", {kPressure, kPoundForce / (0.3048 * 0.3048)}},
      {"inHg", {kPressure, 3386.389}},
      {"J", {kEnergy, 1.0}},
      {"W", {kPower, 1.0}},
      {"V", {kVoltage, 1.0}},
      {"mV", {kVoltage, 1e-3}},
      {"T", {kMagneticField, 1.0}},
      {"mT", {kMagneticField, 1e-3}},
      {"uT", {kMagneticField, 1e-6}},
      {"G", {kMagneticField, 1e-4}},
      {"gauss", {kMagneticField, 1e-4}},
      {"mG", {kMagneticField, 1e-7}},
      {"%", {kNone, 1e-2}},
      {"1", {kNone, 1.0}},
      {"-", {kNone, 1.0}},
  };
  return units;
}

NamedUnit look_up(std::string_view word, std::string_view whole) {
  const auto& units = known_units();
  if (const auto found = units.find(word); found != units.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [name, unit] : units) names.push_back(name);
  const std::string in = word == whole ? "" : fmt::format(" in '{}'", whole);
  throw InputError("", fmt::format("unknown unit '{}'{}{}", word, in, suggestion(word, names)));
}

// "s^2" or "s2" or "s^-1" -> ("s", 2)
std::pair<std::string_view, int> split_power(std::string_view word, std::string_view whole) {
  std::size_t end = word.find('^');
  std::string_view digits;
  if (end != std::string_view::npos) {
    digits = word.substr(end + 1);
  } else {
    end = word.size();
    while (end > 1 && std::isdigit(static_cast<unsigned char>(word[end - 1])) != 0) --end;
    if (end == word.size() || known_units().contains(word)) return {word, 1};
    digits = word.substr(end);
  }
  int power = 0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), power);
  if (error != std::errc{} || stop != digits.data() + digits.size() || power < -9 || power > 9) {
    throw InputError("", fmt::format("unit '{}' has a power '{}' that is not a small whole number", whole, digits));
  }
  return {word.substr(0, end), power};
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) != 0) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.remove_suffix(1);
  return text;
}

std::string kind_of(const Unit& unit) {
  static const std::map<Dimension, std::string> kinds{{kNone, "a plain number"},
                                                      {kLength, "a length"},
                                                      {kMass, "a mass"},
                                                      {kTime, "a time"},
                                                      {kTemperature, "a temperature"},
                                                      {kCurrent, "a current"},
                                                      {kAngle, "an angle"},
                                                      {kSpeed, "a speed"},
                                                      {kAcceleration, "an acceleration"},
                                                      {kRate, "an angular rate"},
                                                      {kFrequency, "a frequency"},
                                                      {kForce, "a force"},
                                                      {kPressure, "a pressure"},
                                                      {kEnergy, "a moment or energy"},
                                                      {kPower, "a power"},
                                                      {Dimension{2, 0, 0, 0, 0, 0}, "an area"},
                                                      {Dimension{2, 1, 0, 0, 0, 0}, "a moment of inertia"}};
  const auto found = kinds.find(unit.dimension);
  return found == kinds.end() ? "" : found->second + " ";
}

/// As `parse_unit`, in its own words only.
Unit parse_standard_words(std::string_view text) {
  const std::string_view whole = trim(text);
  Unit unit;
  unit.name = whole.empty() ? "1" : std::string(whole);
  if (whole.empty()) return unit;
  int sign = 1;
  int factors = 0;
  std::size_t begin = 0;
  while (begin <= whole.size()) {
    const std::size_t end = std::min(whole.find_first_of("/ *.", begin), whole.size());
    const std::string_view word = whole.substr(begin, end - begin);
    const char separator = end < whole.size() ? whole[end] : ' ';
    if (!word.empty()) {
      const auto [name, power] = split_power(word, whole);
      const NamedUnit factor = look_up(name, whole);
      for (std::size_t i = 0; i < Unit::kDimensions; ++i) unit.dimension[i] += sign * power * factor.dimension[i];
      double scale = 1.0;
      for (int i = 0; i < std::abs(power); ++i) scale *= factor.scale;
      unit.scale *= (sign * power > 0) ? scale : 1.0 / scale;
      unit.offset = factor.offset;
      ++factors;
    } else if (separator == '/') {
      throw InputError("", fmt::format("unit '{}' has nothing before or between '/'", whole));
    }
    if (separator == '/') sign = -1;
    begin = end + 1;
  }
  if (factors == 0 || whole.back() == '/') throw InputError("", fmt::format("'{}' is not a unit", whole));
  // A temperature in a compound unit (W/degC) is a difference: its zero does not matter.
  if (factors > 1 || sign < 0) unit.offset = 0.0;
  return unit;
}

}  // namespace

std::string Unit::si_name() const {
  static constexpr std::array<const char*, kDimensions> kBase{"m", "kg", "s", "K", "A", "rad"};
  // A moment and an energy have the same dimension; here it is nearly always a moment, and no one reads a moment in
  // joules.
  static const std::map<Dimension, std::string> derived{{kForce, "N"},        {kPressure, "Pa"}, {kEnergy, "N m"},
                                                        {kPower, "W"},        {kVoltage, "V"},   {kFrequency, "Hz"},
                                                        {kMagneticField, "T"}};
  if (const auto found = derived.find(dimension); found != derived.end()) return found->second;
  // Metre before kilogram reads oddly in "m^2 kg", so mass is written first.
  static constexpr std::array<std::size_t, kDimensions> kOrder{1, 0, 5, 3, 4, 2};
  std::string above;
  std::string below;
  for (const std::size_t i : kOrder) {
    const int power = dimension[i];
    if (power == 0) continue;
    std::string& side = power > 0 ? above : below;
    if (!side.empty()) side += power > 0 ? " " : "/";
    side += kBase[i];
    if (power > 1 || power < -1) side += fmt::format("^{}", power > 0 ? power : -power);
  }
  if (below.empty()) return above.empty() ? "1" : above;
  return (above.empty() ? "1" : above) + "/" + below;
}

Unit Unit::si() const { return Unit{dimension, 1.0, 0.0, si_name()}; }

Unit parse_unit(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  try {
    return parse_standard_words(text);
  } catch (const InputError&) {
    const std::string words = text.size() > kLongest ? std::string(text) : in_standard_words(text);
    if (words == text) throw;
    try {
      Unit unit = parse_standard_words(words);
      unit.name = std::string(trim(text));
      return unit;
    } catch (const InputError&) {
      // What is wrong is said of what was written.
    }
    throw;
  }
}

std::vector<Unit> units_like(const Unit& like) {
  // The common names of what has several, and compounds, before the names of the table.
  static const std::vector<Unit> all = [] {
    std::vector<Unit> units;
    for (const char* name : {"km/h", "ft/s", "cm/s", "mm/s", "deg/s", "mrad/s", "ft/s^2", "g", "cm/s^2", "mm/s^2"})
      units.push_back(parse_unit(name));
    for (const auto& [name, unit] : known_units()) units.push_back({unit.dimension, unit.scale, unit.offset, name});
    return units;
  }();
  std::vector<Unit> found{like.si()};
  for (const Unit& unit : all) {
    const auto same_size = [&](const Unit& other) {
      return std::abs(unit.scale / other.scale - 1.0) < 1e-9 && unit.offset == other.offset;
    };
    if (unit.same_dimension(like) && std::ranges::none_of(found, same_size)) found.push_back(unit);
  }
  return found;
}

Unit parse_unit_like(std::string_view text, const Unit& expected) {
  Unit unit = parse_unit(unit_meant(text, expected));
  if (!unit.same_dimension(expected)) {
    throw InputError("", fmt::format("unit '{}' is {}[{}], expected {}[{}]", unit.name, kind_of(unit), unit.si_name(),
                                     kind_of(expected), expected.si_name()));
  }
  return unit;
}

}  // namespace veridyn
