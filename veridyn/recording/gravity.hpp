#pragma once

#include <span>
#include <string>

#include "veridyn/core/units.hpp"

namespace veridyn::recording {

/// What a vertical acceleration holds in the median over a recording, in which a vehicle is level more often than not.
struct VerticalAcceleration {
  enum class Holds {
    kGravity,  ///< as an accelerometer does
    kNothing,  ///< gravity was taken off
    kTwice,    ///< it was added to what held it
    kUnknown
  };
  Holds holds = Holds::kUnknown;
  double median = 0.0;   ///< [m/s^2]
  double times_g = 0.0;  ///< the median over gravity
  /// The unit in which the numbers are recorded if another one than was said makes them gravity; else empty.
  std::string unit = {};

  /// Gravity, but pointing the other way than the frame says.
  /// @param up 1 where an accelerometer at rest reads +g (flu), -1 where it reads -g (frd)
  [[nodiscard]] bool is_reversed(double up) const { return holds == Holds::kGravity && median * up < 0.0; }
};

/// By the limits of `Check::kGravity`: gravity within the range that is not failed; another unit where it makes the
/// median gravity within the range that passes; nothing where what is left is no more than what gravity may be off by.
/// @param taken the unit in which the numbers were taken to be recorded
[[nodiscard]] VerticalAcceleration vertical_acceleration(double median, const Unit& taken);
/// Of samples [m/s^2]; those that are not finite are left out.
[[nodiscard]] VerticalAcceleration vertical_acceleration(std::span<const double> samples, const Unit& taken);

}  // namespace veridyn::recording
