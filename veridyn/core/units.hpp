#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn {

/// A physical unit: how a number in it becomes SI, and of what dimension it is.
///
/// `si = scale * number + offset`; the offset is zero for all but temperatures. The dimension holds the exponents of
/// metre, kilogram, second, kelvin, ampere and radian. The radian counts as a dimension of its own, so that a length
/// given where an angle is expected, or a frequency in Hz (1/s) in place of a rate in rad/s, is noticed.
struct Unit {
  static constexpr std::size_t kDimensions = 6;
  std::array<int, kDimensions> dimension{};  ///< exponents of m, kg, s, K, A, rad
  double scale = 1.0;
  double offset = 0.0;
  std::string name = "1";  ///< as the user wrote it

  [[nodiscard]] double to_si(double number) const { return scale * number + offset; }
  [[nodiscard]] double from_si(double si) const { return (si - offset) / scale; }
  [[nodiscard]] bool same_dimension(const Unit& other) const { return dimension == other.dimension; }
  /// The name of the SI unit of this dimension: "m/s^2", "rad/s", "1".
  [[nodiscard]] std::string si_name() const;
  /// This dimension in SI: scale 1, offset 0, named by `si_name()`.
  [[nodiscard]] Unit si() const;
};

/// Reads a unit such as "m/s^2", "deg/s", "kg m^2", "1/rad", "kt", "ft/s", "psf", "degC", "g0", "%". An empty text, "1"
/// and "-" are dimensionless. "g" is standard gravity, 9.80665 m/s^2 (a gram is "gram").
/// Factors are separated by blanks, "*" or "." and powers are written "^2", "^-1" or as a digit ("m2"); everything
/// after each "/" up to the next is divided by.
/// @throws InputError naming the unknown word, with the nearest known unit.
[[nodiscard]] Unit parse_unit(std::string_view text);

/// Units of the dimension of `like` in which people record, the SI unit first and each size once: "m/s", "km/h", "kt",
/// "mph", "ft/s".
[[nodiscard]] std::vector<Unit> units_like(const Unit& like);

/// As `parse_unit`, and checks that the unit is of the expected dimension.
/// @throws InputError "unit 'm' is a length [m], expected [kg]"
[[nodiscard]] Unit parse_unit_like(std::string_view text, const Unit& expected);

}  // namespace veridyn
