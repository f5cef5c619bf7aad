#pragma once

#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/output_error/parametric_model.hpp"
#include "veridyn/vehicle/identification/options/drive_structure.hpp"
#include "veridyn/vehicle/identification/options/drive_unknown.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/tyre/tyre_laws.hpp"

namespace veridyn::vehicle {

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
  /// biases of steering, yaw rate and lateral acceleration are not distinguishable without it.
  PerDriveUnknown<double> prior{};
  /// Cut-off of the kernel before the comparison [Hz]; 0: none; negative: the steering alone is filtered, by its own
  /// spectrum (`numerics::denoised`). Noise of the steering acts on the lateral acceleration at once (2 C_f/m times
  /// it), and what it adds to the power of the slip angle is taken off the stiffnesses.
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
/// The options with the unknowns of `kDriveBudget` at their starts.
[[nodiscard]] DriveModelOptions without_budget(DriveModelOptions options);
/// The options with these effects, whose unknowns are free, and no others.
[[nodiscard]] DriveModelOptions with_effects(DriveModelOptions options, const DriveEffects& effects);

}  // namespace veridyn::vehicle
