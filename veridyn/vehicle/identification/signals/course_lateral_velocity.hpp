#pragma once

#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/numerics/resample.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::vehicle {

/// Below it a course says little of where a vehicle goes, and receivers freeze it [m/s].
inline constexpr double kSlowestCourse_mps = 2.0;
/// How much the offset between course and heading may wander in straight driving [rad]: a compass that turns with the
/// car's iron, or a heading that drifts, says nothing of the sideslip.
inline constexpr double kWanderingHeading = 0.05;

/// View of what a lateral velocity is made of.
struct CourseProblem {
  const Channel& course;                ///< direction in which the antenna moves, left positive [rad]
  const Channel& yaw;                   ///< heading, left positive [rad]
  const std::vector<double>& speed;     ///< u on the grid [m/s]
  const std::vector<double>& yaw_rate;  ///< r on the grid [rad/s]
  double speed_sigma = 0.0, yaw_rate_sigma = 0.0;
  numerics::UniformGrid grid;
  double position = 0.0;  ///< of the antenna, ahead of the centre of gravity [m]
};

/// Lateral velocity of the centre of gravity and what was done; no signal where course and heading do not tell it, and
/// the note says why.
struct CourseLateralVelocity {
  recording::GridSignal signal;
  double shift_s = 0.0;  ///< by which the course was taken to be late
  std::string note = {};
};

/// Lateral velocity of the centre of gravity,
///
///     v = u tan(course - heading - offset) - x r,
///
/// x the antenna's place ahead of it. The offset between both (another zero, a mounting) is the median of their
/// difference in straight driving (|u r| < 0.3 m/s^2), where a car has no sideslip. NaN below kSlowestCourse_mps and
/// where the difference is beyond 30 deg (reversing). Values that a receiver holds over several stamps count once.
///
/// Receivers are late. A course that is best explained by the heading 0.1 s ago or more is shifted by that: sideslip at
/// speeds above 8 m/s looks like less.
///
/// Error of a sample, to first order, with the noise of all four, 0.05 m of the antenna's place, and w how far the
/// offset wanders between straight stretches:
///
///     sigma^2 = (u / cos^2)^2 (sigma_course^2 + sigma_heading^2 + w^2) + (tan sigma_u)^2 + (x sigma_r)^2 + (0.05 r)^2,
///
/// its mean over the samples. What lasts is left to the fit: sideslip_bias and course_delay of the drive model (a
/// course that is still tau late reads v - tau a_y).
[[nodiscard]] CourseLateralVelocity course_lateral_velocity(const CourseProblem& problem);

}  // namespace veridyn::vehicle
