#pragma once

#include "veridyn/vehicle/identification/fit/vehicle_problem.hpp"
#include "veridyn/vehicle/identification/options/drive_structure.hpp"

namespace veridyn::vehicle {

/// Spread of the segments' mean of a_y - r u from which a bank is tried [m/s^2]: the crossfall of ordinary roads, 2 %.
inline constexpr double kTellingBank_mps2 = 0.2;
/// Share by which a usual downforce (kDownforceSigma) has to change stiffness over the speeds driven: intervals of
/// gentle drives are no narrower.
inline constexpr double kTellingDownforce = 0.1;
/// Share of an axle's load that the pedals have to move, rms.
inline constexpr double kTellingPedals = 0.05;
/// The same where downforce is tried.
inline constexpr double kPedalsBesideDownforce = 0.01;

/// Which effects the identification segments of a drive can tell: what is tried where the study fixes none. A bank
/// needs an accelerometer and more than one segment: what all have in common is its bias. Downforce needs speeds of
/// which the squares differ by 200 m^2/s^2 (15 and 21 m/s), pedals an rms of about 1.2 m/s^2 (5 % of an axle's load).
[[nodiscard]] DriveEffects distinguishable_effects(const VehicleProblem& problem);

}  // namespace veridyn::vehicle
