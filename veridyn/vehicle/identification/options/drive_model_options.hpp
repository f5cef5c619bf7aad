#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/output_error/parametric_model.hpp"
#include "veridyn/vehicle/identification/options/drive_structure.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/tyre/tyre_laws.hpp"

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
  kAccelPlace    ///< how far ahead of its given place the accelerometer is [m]
};
/// How many unknowns there are.
inline constexpr std::size_t kDriveUnknowns = 35;
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
                                                                      "accel_place"};
/// Their units, in the same order.
inline constexpr PerDriveUnknown<std::string_view> kDriveUnknownUnits{
    "N/rad", "N/rad", "kg m^2",  "m",       "1",   "1", "1",     "rad s^2/m", "m",   "m", "1",
    "1",     "1",     "s^2/m^2", "s^2/m^2", "1",   "1", "rad/s", "1", "1", "1", "m", "rad", "1", "rad/s",
    "m/s^2", "1",     "rad",     "rad/s",   "rad", "s", "s",     "s",         "s", "m"};
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

/// Tyres of the drive model: any law that numbers describe. Its stiffnesses are C_f and C_r; mu, C and E are unknowns
/// where it has them.
using DriveTyre = AllTyresByNumbers::Variant<TyreLaw>;
/// One of them: `kDriveTyre<LinearTyre>`.
template <template <typename> typename Tyre>
inline constexpr DriveTyre kDriveTyre = TyreLaw<Tyre<double>>();
/// Whether such tyres have mu, C or E.
[[nodiscard]] bool has_unknown(const DriveTyre& tyre, DriveUnknown u);

/// Study keys of `[identify]`.
struct DriveModelOptions {
  DriveTyre tyre = kDriveTyre<LinearTyre>;
  /// What moves; no key of its own: `VehicleIdentifyOptions::structure` chooses. Its unknowns are free.
  DriveStructure structure = DriveStructure::kBicycle;
  /// No key of its own either: `VehicleIdentifyOptions::effects`.
  DriveEffects effects{};
  /// What is free; the rest stays at its start.
  PerDriveUnknown<bool> free{};
  /// Where the search begins; also the mean of the prior. NaN: by the vehicle's geometry, see `with_geometry`.
  PerDriveUnknown<double> start{};
  /// Standard deviation of what is known beforehand; infinite: nothing; NaN: by the geometry. At one constant speed the
  /// biases of steering, yaw rate and lateral acceleration cannot be told apart without it.
  PerDriveUnknown<double> prior{};
  /// Cut-off of the kernel before the comparison [Hz]; 0: none; negative: by the steering's noise, which acts on the
  /// lateral acceleration at once (2 C_f/m times it): 0.1 deg of white noise at 100 Hz on 0.9 deg rms of slip takes
  /// 1.3 % off C_f, 4 Hz leave a tenth of that.
  double smoothing_Hz = -1.0;
  /// C_f, C_r and I_z are looked for between their start over this and times it; no key.
  double search_factor = 1e3;
  double gravity = kGravity;
  /// Biases to which each segment adds a constant of its own, with their priors; no key.
  std::vector<DriveUnknown> offsets = {};
  double finer_steps = 1.0;  ///< how many times finer the integration steps than output error needs; no key

  DriveModelOptions();
  /// Of the table `[identify]`.
  [[nodiscard]] static const KeyTable<DriveModelOptions>& keys();
};

/// The options with every start and prior a number. What was NaN is that of the vehicle: C_f, C_r, I_z and a its own;
/// roll gradient 0.0089 +- 0.0045 rad/(m/s^2) (5 deg/g; where one is given, `roll_gradient` > 0, that within a fifth),
/// roll frequency 10 rad/s +- 40 % on a wheelbase of 2.6 m (as the root of its inverse), damping ratio 0.3 +- 0.2, the
/// centre of gravity 0.85 +- 0.25 of its height above the roll axis (roll axes lie up to 0.15 m above the road,
/// Milliken & Milliken 1995, chapter 17), relaxation length 0.12 +- 0.06 of the wheelbase (0.3 m, Pacejka 2006, chapter
/// 5), load transfer that of a rigid car, twice the height of the centre of gravity over the track, within a quarter.
[[nodiscard]] DriveModelOptions with_geometry(DriveModelOptions options, const VehicleParameters<double>& vehicle,
                                              double roll_gradient);

/// The shortest relaxation length that is looked for, as a share of the wheelbase: a tenth of a metre.
inline constexpr double kShortestRelaxation = 0.04;

/// How late steering and outputs may be, either way [s]: a segment is driven by what was recorded so far around it.
inline constexpr double kLongestDelay_s = 0.5;
/// An unknown as the options have it, with the bounds between which it is searched.
[[nodiscard]] estimation::ModelParameter model_parameter(DriveUnknown unknown, const DriveModelOptions& options,
                                                         double wheelbase);

/// The options with what a lateral velocity of course and heading leaves open, free where there is one (`by_course`).
[[nodiscard]] DriveModelOptions with_course(DriveModelOptions options, bool by_course);

/// The options for a structure, whose unknowns are free.
[[nodiscard]] DriveModelOptions with_structure(DriveModelOptions options, DriveStructure structure);

/// What is known of a road's bank before the data [rad]: crossfall and banked turns of public roads are 0.02 to 0.08.
inline constexpr double kBankSigma = 0.06;
/// And of downforce [s^2/m^2]: racing cars gain as much force as they have at rest at 35 to 70 m/s, 2e-4 to 8e-4.
inline constexpr double kDownforceSigma = 5e-4;
/// The options with these effects, whose unknowns are free, and no others.
[[nodiscard]] DriveModelOptions with_effects(DriveModelOptions options, const DriveEffects& effects);

}  // namespace veridyn::vehicle
