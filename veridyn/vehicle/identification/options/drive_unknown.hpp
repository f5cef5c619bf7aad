#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "veridyn/core/enum_array.hpp"

namespace veridyn::vehicle {

/// Unknowns of the drive model, in this order.
enum class DriveUnknown : std::size_t {
  kCf,                   ///< cornering stiffness of one front tyre [N/rad]
  kCr,                   ///< of one rear tyre
  kIz,                   ///< yaw inertia [kg m^2]
  kA,                    ///< centre of gravity to front axle [m]; the wheelbase stays
  kMu,                   ///< peak friction coefficient D/F_z of the Magic Formula [-]
  kShape,                ///< its shape factor C [-]
  kCurvature,            ///< its curvature factor E [-]
  kRollGradient,         ///< steady roll per lateral acceleration [rad/(m/s^2)]
  kRollArm,              ///< centre of gravity above the roll axis [m]
  kRelaxationLength,     ///< travel in which the slip angles follow by 63 % [m]
  kLoadTransfer,         ///< share of a wheel's static load that moves to the other side at 1 g [-]
  kLoadTransferLoss,     ///< share of the axles' force that is lost where the body leans as much as at 1 g [-]
  kLoadTransferBalance,  ///< by how much of it the front axle loses more than that, and the rear one less [-]
  kDownforceF,           ///< growth of the front axle's forces per square of the speed [s^2/m^2]
  kDownforceR,           ///< of the rear axle's
  kLoadSensitivity,      ///< growth of an axle's forces over that of its load by braking and driving [-]
  kFrontForceShare,      ///< what the front axle has of the force along the vehicle [-]
  /// Undamped natural frequency of roll [rad/s] and its damping ratio [-]: effective values of one mode. A drive shows
  /// how late roll is, 2 damping/frequency; springs of the tyres below those of the body make both larger than the body
  /// alone has them.
  kRollFrequency,
  kRollDamping,
  kRollSteerF,    ///< slip of the front tyres per roll: roll steer, camber thrust over the stiffness [rad/rad]
  kRollSteerR,    ///< of the rear ones
  kTrail,         ///< how far behind the middle of their contact tyres' side forces act [m]
  kSteerBias,     ///< measured minus true [rad]
  kSteerScale,    ///< measured over true, less 1: steering ratio, compliance [-]
  kYawRateBias,   ///< [rad/s]
  kAccelYBias,    ///< [m/s^2]: sensor and mean bank
  kAccelYScale,   ///< measured over true, less 1 [-]
  kRollBias,      ///< where roll is recorded [rad]
  kRollRateBias,  ///< where the roll rate is recorded [rad/s]
  kSideslipBias,  ///< of a lateral velocity made of course and heading, over the speed [rad]
  kSteerDelay,    ///< how late the front wheels' force answers the recorded steering [s]
  kYawRateDelay,  ///< how late the yaw rate is recorded [s]
  kAccelYDelay,
  kCourseDelay,  ///< how late the course is, of which a lateral velocity is made [s]
  kAccelPlace,   ///< how far ahead of its given place the accelerometer is [m]
  kAccelHeight   ///< how far above it [m]
};
/// How many unknowns there are.
inline constexpr std::size_t kDriveUnknowns = 36;
/// All of them, in order.
inline constexpr auto kAllDriveUnknowns = enumerators<DriveUnknown, kDriveUnknowns>();
/// What the model of every structure has of the vehicle.
inline constexpr std::array kBasicUnknowns{DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz};
/// Those that are the vehicle's, not the day's, beside what a structure adds.
inline constexpr std::array kVehicleUnknowns{DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz, DriveUnknown::kA,
                                             DriveUnknown::kMu};
/// A value for each of them.
template <class T>
using PerDriveUnknown = EnumArray<DriveUnknown, T, kDriveUnknowns>;
/// Their names in studies and results, in the order of the enum.
inline constexpr PerDriveUnknown<std::string_view> kDriveUnknownNames{"C_f",
                                                                      "C_r",
                                                                      "I_z",
                                                                      "a",
                                                                      "mu",
                                                                      "C",
                                                                      "E",
                                                                      "roll_gradient",
                                                                      "roll_arm",
                                                                      "relaxation_length",
                                                                      "load_transfer",
                                                                      "load_transfer_loss",
                                                                      "load_transfer_balance",
                                                                      "downforce_f",
                                                                      "downforce_r",
                                                                      "load_sensitivity",
                                                                      "front_force_share",
                                                                      "roll_frequency",
                                                                      "roll_damping",
                                                                      "roll_steer_f",
                                                                      "roll_steer_r",
                                                                      "trail",
                                                                      "steer_bias",
                                                                      "steer_scale",
                                                                      "yaw_rate_bias",
                                                                      "accel_y_bias",
                                                                      "accel_y_scale",
                                                                      "roll_bias",
                                                                      "roll_rate_bias",
                                                                      "sideslip_bias",
                                                                      "steer_delay",
                                                                      "yaw_rate_delay",
                                                                      "accel_y_delay",
                                                                      "course_delay",
                                                                      "accel_place",
                                                                      "accel_height"};
/// Their units, in the same order.
inline constexpr PerDriveUnknown<std::string_view> kDriveUnknownUnits{
    "N/rad", "N/rad",   "kg m^2",  "m",   "1",     "1",     "1", "rad s^2/m", "m", "m", "1",   "1",
    "1",     "s^2/m^2", "s^2/m^2", "1",   "1",     "rad/s", "1", "1",         "1", "m", "rad", "1",
    "rad/s", "m/s^2",   "1",       "rad", "rad/s", "rad",   "s", "s",         "s", "s", "m",   "m"};
static_assert(!kDriveUnknownNames.back().empty() && !kDriveUnknownUnits.back().empty(), "one is missing");
/// Whether a parameter is one of these unknowns.
[[nodiscard]] constexpr bool is_one_of(std::string_view parameter, std::span<const DriveUnknown> unknowns) {
  return std::ranges::any_of(unknowns, [&](DriveUnknown u) { return kDriveUnknownNames[u] == parameter; });
}
/// Whether it is an offset of a sensor, which each drive has its own of.
[[nodiscard]] constexpr bool is_bias(DriveUnknown u) {
  return u == DriveUnknown::kSteerBias || u == DriveUnknown::kYawRateBias || u == DriveUnknown::kAccelYBias ||
         u == DriveUnknown::kRollBias || u == DriveUnknown::kRollRateBias || u == DriveUnknown::kSideslipBias;
}

}  // namespace veridyn::vehicle
