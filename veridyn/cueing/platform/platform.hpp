#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/cueing/platform/legs.hpp"
#include "veridyn/cueing/platform/platform_limits.hpp"

namespace veridyn::cueing {

/// How an actuator follows its command: second order, behind a delay.
struct ActuatorOptions {
  double omega = 30.0;  ///< natural frequency [rad/s]; 0: it follows at once
  double zeta = 1.0;    ///< damping ratio
  double delay = 0.01;  ///< [s]
};

/// Where an axis comes to rest by what is commanded: points of lines, in order; beyond them at the end's.
struct StaticReach {
  std::vector<double> commanded, reached;  ///< [m or rad]

  [[nodiscard]] bool empty() const { return commanded.empty(); }
  /// What is reached and its derivative.
  struct Point {
    double reached = 0.0, slope = 1.0;
  };
  [[nodiscard]] Point at(double command) const;
};

/// A platform as data.
struct Platform {
  std::string name;
  PlatformLimits limits;
  std::optional<LegGeometry> legs;  ///< nothing: each axis has an actuator of its own
  ActuatorOptions actuators;
  /// Of axes that were measured one by one; an axis without follows as `actuators`. With legs these hold for the axes,
  /// and the legs follow them at once.
  PerPlatformAxis<std::optional<ActuatorOptions>> axis_actuators = {};
  PerPlatformAxis<StaticReach> reach = {};  ///< empty: it comes to rest where it is commanded
  Eigen::Vector3d rider = {0.0, 0.0,
                           -0.8};  ///< the driver's head from the centre of rotation: forward, right, down [m]

  /// Reads `[platform]`: a built-in one or a file's (`veridyn rig test` writes them), whose values other keys replace.
  /// @throws InputError with file, line and key.
  [[nodiscard]] static Platform read(const StudyTable& table);
  /// All keys of `[platform]`.
  [[nodiscard]] static StudyKeys study_keys();
  /// @throws InputError naming what cannot be: limits, legs that do not reach, a delay of half a second or more.
  void validate() const;
  /// How an axis follows.
  [[nodiscard]] const ActuatorOptions& response(PlatformAxis axis) const {
    return axis_actuators[axis] ? *axis_actuators[axis] : actuators;
  }
};

/// "three_axis": roll, pitch and heave on three upright actuators. "three_axis_measured": the same with the resting
/// places that were measured of such a platform, which reaches less than is commanded at large angles. "hexapod": six
/// axes on six legs. "ideal": six axes, 10 m and 60 deg each way, at once where they are commanded: what an algorithm
/// does by itself. @throws InputError with the nearest name.
[[nodiscard]] const Platform& built_in_platform(std::string_view name);
/// All of them.
[[nodiscard]] const std::vector<Platform>& built_in_platforms();

}  // namespace veridyn::cueing
