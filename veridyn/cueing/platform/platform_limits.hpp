#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::cueing {

/// The axes of a platform, in platform axes as `PlatformCommand` has them.
enum class PlatformAxis { kSurge, kSway, kHeave, kRoll, kPitch, kYaw };
/// How many axes there are.
inline constexpr std::size_t kPlatformAxes = 6;
/// All of them, in order.
inline constexpr auto kAllPlatformAxes = enumerators<PlatformAxis, kPlatformAxes>();
/// A value for each axis.
template <class T>
using PerPlatformAxis = EnumArray<PlatformAxis, T, kPlatformAxes>;

/// "surge", "sway", ...
[[nodiscard]] std::string_view name_of(PlatformAxis axis);
/// Whether the axis turns: its unit is rad, else m.
[[nodiscard]] constexpr bool turns(PlatformAxis axis) { return axis >= PlatformAxis::kRoll; }

/// What one axis can do [m or rad, s]. An axis that cannot move has lowest = highest = 0.
struct AxisLimits {
  double lowest = 0.0, highest = 0.0;  ///< position against neutral; zero lies between
  double rate = 1.0;                   ///< largest in either direction, like the next two
  double acceleration = 10.0;
  double jerk = 200.0;

  [[nodiscard]] bool moves() const { return highest > lowest; }
};

/// What a platform can do, axis by axis.
struct PlatformLimits {
  PerPlatformAxis<AxisLimits> axes = {};

  /// Reads what `[platform]` says of the axes over what is there already; an axis that neither has cannot move.
  /// @throws InputError with file, line and key.
  void read_over(const StudyTable& table);
  /// @throws InputError where a range does not hold zero, a limit is not above zero, or no axis moves.
  void validate() const;

  /// The axes that move, in order.
  [[nodiscard]] std::vector<PlatformAxis> moving_axes() const;

  [[nodiscard]] const AxisLimits& operator[](PlatformAxis axis) const { return axes[axis]; }
  [[nodiscard]] AxisLimits& operator[](PlatformAxis axis) { return axes[axis]; }
};

/// The keys of an axis; without a unit of any, to be shown.
[[nodiscard]] KeyTable<AxisLimits> axis_keys(const std::string& name, const std::string& unit = {});

/// Three axes, one above the other: roll +-20 deg, pitch +20/-15 deg, heave +-100 mm, 30 deg/s and 0.3 m/s,
/// 200 deg/s^2 and 3 m/s^2. Positions are those that the source of the reproduced experiments gives, the others are
/// usual of such platforms.
[[nodiscard]] PlatformLimits three_axis_limits();
/// A hexapod of medium size: +-0.5 m (heave +-0.4 m), +-20 deg, 0.6 m/s and 35 deg/s, 6 m/s^2 and 200 deg/s^2.
[[nodiscard]] PlatformLimits hexapod_limits();

}  // namespace veridyn::cueing
