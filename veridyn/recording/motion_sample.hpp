#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "veridyn/core/recording.hpp"

namespace veridyn::recording {

/// Where a quantity of a motion sample comes from.
enum class Origin {
  kAbsent,    ///< not known; its value is zero, the attitude's level
  kMeasured,  ///< by a sensor or a simulation
  kDerived,   ///< computed from others
};

/// What the driver of a ground vehicle does.
struct DriverInputs {
  double steer = 0.0;         ///< at the road wheels, left positive in any frame [rad]
  double drive_torque = 0.0;  ///< of all driven wheels together [N m]
  double brake_torque = 0.0;  ///< of all wheels together, >= 0 [N m]
};

/// The motion of a body at a moment, at a place on it, as a person there would feel it. Vectors are in body axes.
struct MotionSample {
  double time = 0.0;                                ///< [s]
  Frame frame = Frame::kFlu;                        ///< of all vectors: kFrd or kFlu
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< from the centre of gravity [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< specific force f = a - g, what an accelerometer shows [m/s^2]
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();   ///< angular rate [rad/s]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  ///< [rad/s^2]
  /// Body to world components; the world's axes are north, east, down with kFrd, north, west, up with kFlu.
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();
  /// Of the place, along the world's two level axes, from wherever the recording counts [m].
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double speed = 0.0;  ///< forward [m/s]
  DriverInputs inputs;
  Origin force_from = Origin::kAbsent, rate_from = Origin::kAbsent, angular_acceleration_from = Origin::kAbsent,
         attitude_from = Origin::kAbsent, position_from = Origin::kAbsent, speed_from = Origin::kAbsent,
         steer_from = Origin::kAbsent, torque_from = Origin::kAbsent;
};

/// The specific force of a body at rest and level, +g along the axis that points up [m/s^2].
[[nodiscard]] Eigen::Vector3d force_at_rest(Frame frame);

/// The same motion in the axes of another frame: half a turn about the forward axis.
[[nodiscard]] MotionSample in_frame(const MotionSample& sample, Frame frame);

/// The same motion at another place of the rigid body: f + alpha x d + omega x (omega x d), d from the sample's place
/// to the new one. @param place from the centre of gravity, in the sample's axes [m]
[[nodiscard]] MotionSample at_place(const MotionSample& sample, const Eigen::Vector3d& place);

/// Acceleration against the world, a = f + g, in body axes [m/s^2]: needs the attitude.
[[nodiscard]] Eigen::Vector3d acceleration(const MotionSample& sample);

}  // namespace veridyn::recording
