#pragma once

#include <Eigen/Core>

#include "veridyn/cueing/perception/vestibular_model.hpp"
#include "veridyn/numerics/linear_systems/state_space.hpp"

namespace veridyn::cueing {

/// How the error of what a rider feels of one pair of axes follows from what the platform does, for small angles: surge
/// with pitch, or sway with roll (all of which is then written to the left). The continuous system's
///
///     states    otoliths (2) and canals (3) of rider less driver, angle and its rate; shift and its rate
///     inputs    second derivatives of angle and shift; the vehicle's specific force and angular rate
///     outputs   felt force and felt turn of the rider less those of the driver, over their thresholds
///
/// The rider feels g angle + shift'' - height angle'', turns with angle', and the driver force and rate.
struct FeltPair {
  static constexpr Eigen::Index kOtolithStates = 2, kFeltStates = 5;
  static constexpr Eigen::Index kAngle = 5, kAngleRate = 6, kShift = 7, kShiftRate = 8;        // states
  static constexpr Eigen::Index kAngleInput = 0, kShiftInput = 1, kForce = 2, kRateInput = 3;  // inputs

  numerics::StateSpace system;  ///< nine states where the platform shifts, else seven
};

/// @param pair 0: sway and roll, 1: surge and pitch @param height of the rider's head above the centre of rotation [m]
/// @throws InputError for organs of other orders, or that pass their input on directly.
[[nodiscard]] FeltPair felt_pair(const VestibularModel& model, const MotionThresholds& thresholds, Eigen::Index pair,
                                 bool shifts, double height);

}  // namespace veridyn::cueing
