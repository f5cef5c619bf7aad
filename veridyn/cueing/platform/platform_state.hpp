#pragma once

#include "veridyn/cueing/platform/platform_command.hpp"
#include "veridyn/cueing/platform/platform_limits.hpp"
#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::cueing {

/// Where a platform is and how it moves, in platform axes; `rate` is of the angles.
struct PlatformState : PlatformCommand {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              ///< of the shift [m/s]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  ///< second derivative of the angles [rad/s^2]
};

/// Of one axis [m or rad, s].
struct AxisState {
  double position = 0.0, rate = 0.0, acceleration = 0.0;
};
/// What a platform does along an axis.
[[nodiscard]] AxisState axis(const PlatformState& state, PlatformAxis which);
/// Makes it do that.
void set_axis(PlatformState& state, PlatformAxis which, const AxisState& to);
/// Shift or angle of a command along an axis.
[[nodiscard]] double position(const PlatformCommand& command, PlatformAxis axis);

/// Angular rate in the platform's own axes, forward, right, down [rad/s].
[[nodiscard]] Eigen::Vector3d body_rate(const PlatformState& state);

/// What somebody on the platform feels: motion in the platform's own axes (kFrd) at a place on it.
/// @param place forward, right, down from the centre about which the platform turns [m]
[[nodiscard]] recording::MotionSample rider_motion(const PlatformState& state,
                                                   const Eigen::Vector3d& place = Eigen::Vector3d::Zero());

}  // namespace veridyn::cueing
