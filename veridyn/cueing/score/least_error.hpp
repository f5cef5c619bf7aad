#pragma once

#include <optional>
#include <vector>

#include "veridyn/cueing/perception/vestibular_model.hpp"
#include "veridyn/cueing/platform/platform.hpp"
#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::cueing {

/// The least perceived error that a platform can leave on a drive if all of it is known beforehand, of one pair of axes
/// (surge with pitch, or sway with roll): what no algorithm can be better than. The error is
///
///     e = sqrt(mean((felt force's error / its threshold)^2 + (felt turn's error / its threshold)^2))
///
/// and the platform's range, rates and accelerations are the limits; jerk, legs, actuators and delay are not, so that
/// the bound is a little too low. Angles are taken for small ones (2 % at 20 deg).
struct LeastError {
  double error = 0.0;  ///< e, in thresholds
  double still = 0.0;  ///< that of a platform that stands
  int iterations = 0;
  /// By how much the cost could still be lower at most, as a share of it: sum of the bounds' distances times
  /// multipliers.
  double residual = 0.0;
  std::vector<double> time, angle, shift;  ///< the motion that does it, 50 Hz [s, rad, m]
};

/// By a quadratic programme over the whole drive (`numerics::HorizonProgramme`). @param vehicle at the driver's head
/// @param pair 0: sway and roll, 1: surge and pitch
/// @return nothing for drives above `kLongestForLeastError`, and where the iteration does not end
/// @throws InputError as `felt_pair`, and for a pair that the platform cannot render.
[[nodiscard]] std::optional<LeastError> least_error(const std::vector<recording::MotionSample>& vehicle,
                                                    const Platform& platform, const VestibularModel& model,
                                                    const MotionThresholds& thresholds, Eigen::Index pair);

/// Drives above this have no bound: it would take gigabytes [s].
inline constexpr double kLongestForLeastError = 900.0;

}  // namespace veridyn::cueing
