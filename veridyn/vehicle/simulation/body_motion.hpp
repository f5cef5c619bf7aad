#pragma once

#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::vehicle {

/// How the body of a vehicle moves at a moment, as the models have it: in the axes of the road under it, turned with
/// the heading, then pitched and rolled. Left side up and nose down are positive.
struct BodyMotion {
  double time = 0.0;                                                                 ///< [s]
  double x = 0.0, y = 0.0;                                                           ///< earth axes [m]
  double yaw = 0.0, roll = 0.0, pitch = 0.0;                                         ///< [rad]
  double yaw_rate = 0.0, roll_rate = 0.0, pitch_rate = 0.0;                          ///< [rad/s]
  double yaw_acceleration = 0.0, roll_acceleration = 0.0, pitch_acceleration = 0.0;  ///< [rad/s^2]
  double forward = 0.0, leftward = 0.0, upward = 0.0;  ///< accelerations of the centre of gravity [m/s^2]
  double speed = 0.0;                                  ///< forward [m/s]
};

/// The motion at the centre of gravity as a person would feel it, flu. Attitude: heading, grade, then pitch and roll.
/// The yaw rate is about the road's normal; gravity square to the road is counted, so that a car parked on a grade
/// shows g sin(grade) forward.
/// @param grade of the road along the heading, uphill positive [rad]; @param gravity [m/s^2]
[[nodiscard]] recording::MotionSample motion_sample(const BodyMotion& body, double gravity, double grade = 0.0);

}  // namespace veridyn::vehicle
