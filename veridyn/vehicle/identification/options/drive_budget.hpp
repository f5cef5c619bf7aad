#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "veridyn/vehicle/identification/options/drive_unknown.hpp"

namespace veridyn::vehicle {

/// What is taken of an unknown of sensors and tyres of which a study says nothing: 0, with this standard deviation.
struct DrivePrior {
  DriveUnknown unknown;
  double sigma;  ///< in the unit of the unknown
  std::string_view meaning;
  std::string_view source;
};

/// What can be wrong in the same way in all samples of a drive, which more of them do not make smaller: each is an
/// unknown of every output error beside the vehicle's, with such a prior. What the drive says of it corrects the
/// vehicle's parameters, what it leaves open is in their intervals. Those of roll count where the body rolls.
inline constexpr std::array kDriveBudget{
    DrivePrior{DriveUnknown::kSteerDelay, 0.02, "how late the recorded steering is answered",
               "ours: messages of a CAN bus at 50 to 100 Hz and filters of column sensors are 10 to 20 ms old each"},
    DrivePrior{DriveUnknown::kAccelYDelay, 0.01, "how late accel_y is recorded against yaw_rate",
               "ours: one sample at 100 Hz between two filters of one instrument"},
    DrivePrior{DriveUnknown::kAccelPlace, 0.3, "how far ahead of its given place the accelerometer is",
               "ours: between the front seats or on the tunnel, where the centre of gravity is not known better"},
    DrivePrior{DriveUnknown::kAccelHeight, 0.2, "how far above its given place the accelerometer is",
               "ours: from the floor to the dashboard, where the height of the centre of gravity is not known better"},
    DrivePrior{DriveUnknown::kTrail, 0.015, "how far behind the middle of the contact side forces act",
               "pneumatic trails of passenger cars' tyres are 0 to 0.04 m (Pacejka 2006, chapter 1)"},
    DrivePrior{DriveUnknown::kRollSteerF, 0.05, "slip angle of the front tyres per roll",
               "roll steer and camber thrust are 0 to 0.1 either way (Milliken & Milliken 1995, chapter 17)"},
    DrivePrior{DriveUnknown::kRollSteerR, 0.05, "the same of the rear tyres", "as in front"}};

/// The scale of the steering is the same in all samples too, and is in the intervals, but is not corrected: what a
/// drive seems to say of it is what the model lacks. Estimated from the identification and from the hold-out part of a
/// drive of CommonRoad's second multi-body car, which has no such error, it came out -0.012 +- 0.008 and 0.048 +-
/// 0.007.
inline constexpr DrivePrior kSteerScalePrior{
    DriveUnknown::kSteerScale, 0.03, "measured over true steering, less 1; in the intervals, never corrected",
    "ours: steering gears whose ratio is of a data sheet, or measured by a protractor at one angle"};

/// Whether an unknown is one of these.
[[nodiscard]] constexpr bool is_in_budget(DriveUnknown unknown) {
  return std::ranges::any_of(kDriveBudget, [&](const DrivePrior& prior) { return prior.unknown == unknown; });
}

}  // namespace veridyn::vehicle
