#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"

namespace veridyn::vehicle {

/// What the identified model has.
enum class DriveStructure : std::size_t {
  kBicycle,      ///< lateral velocity and yaw rate
  kScaledAccel,  ///< the same, and an accelerometer whose scale is wrong: what roll has to be told from
  kRoll,         ///< and the body's roll on its springs
  kRelaxation,   ///< and tyres whose slip follows after a relaxation length
  /// And tyres whose stiffness falls with their force (Fiala), with the load that moves from one wheel to the other;
  /// relaxation length 0: slip at once
  kSaturation,
  /// The same with the reduced Magic Formula, whose stiffness falls later and more, and with what an axle loses by the
  /// load that moves
  kMagicFormula
};
/// How many there are.
inline constexpr std::size_t kDriveStructures = 6;
/// Their names in studies and results, in the order of the enum.
inline constexpr EnumArray<DriveStructure, std::string_view, kDriveStructures> kDriveStructureNames{
    "bicycle",
    "bicycle, accel_y scaled",
    "roll",
    "roll and relaxation",
    "roll, relaxation and saturation",
    "roll, relaxation and Magic Formula"};
/// As study files and estimates name it.
[[nodiscard]] constexpr std::string_view to_string(DriveStructure structure) { return kDriveStructureNames[structure]; }

/// What road, air and pedals of a racing car add to any structure, where the recording can tell.
enum class DriveEffect : std::size_t {
  kBank,       ///< a road that leans sideways, by an angle for each segment
  kDownforce,  ///< axles whose forces grow with the square of the speed
  kPedals      ///< and with the load that braking and driving move from one to the other
};
/// How many there are.
inline constexpr std::size_t kDriveEffectCount = 3;
/// All of them, in the order in which they are tried.
inline constexpr auto kAllDriveEffects = enumerators<DriveEffect, kDriveEffectCount>();
/// Which of them a model has.
using DriveEffects = EnumArray<DriveEffect, bool, kDriveEffectCount>;
/// Their names in studies and results, in the order of the enum.
inline constexpr EnumArray<DriveEffect, std::string_view, kDriveEffectCount> kDriveEffectNames{
    "banked road", "downforce", "load moved by pedals"};
/// A structure with what is added to it: "roll, banked road".
[[nodiscard]] std::string name_of(DriveStructure structure, const DriveEffects& effects);

/// Whether its body rolls.
[[nodiscard]] constexpr bool has_roll(DriveStructure structure) { return structure >= DriveStructure::kRoll; }
/// Whether the slip of its tyres may lag.
[[nodiscard]] constexpr bool has_relaxation(DriveStructure structure) {
  return structure >= DriveStructure::kRelaxation;
}

/// Whether its tyres have a friction limit.
[[nodiscard]] constexpr bool saturates(DriveStructure structure) { return structure >= DriveStructure::kSaturation; }

/// One structure that was fitted to the identification segments and tried on the hold-out.
struct TriedStructure {
  DriveStructure structure = DriveStructure::kBicycle;
  DriveEffects effects = {};
  bool usable = false;
  bool at_bound = false;  ///< one of the unknowns that it adds is at a bound
  std::string message = {};
  double negative_log_likelihood = kNaN;  ///< of the identification segments, without a constant
  /// What priors and the widths of the posterior add to the logarithm of the evidence (Laplace's approximation),
  /// without a constant: only differences between structures count.
  double log_prior_volume = 0.0;
  double inflation = 1.0;        ///< of variances by the residual's autocorrelation: samples that say what one would
  double holdout_misfit = kNaN;  ///< sum of the logarithms of the rms of all outputs' residuals on the hold-out
  double holdout_rmse = kNaN;    ///< of the predicted yaw rate [rad/s]; NaN without a hold-out
  std::array<double, 3> value{}, sigma{};  ///< C_f, C_r, I_z, before intervals are widened
};

/// A structure that the data neither ask for nor exclude, beside the one that is taken.
struct StructureDoubt {
  DriveStructure structure = DriveStructure::kRelaxation;
  DriveEffects effects = {};
  double probability = 0.0;  ///< against the one that is taken
  /// By how much it would move the parameters that both have; by name, each in its unit.
  std::vector<std::pair<std::string, double>> difference = {};
};

/// Probability of a structure against another, both as likely before the data and fitted under one weighing of the
/// residual: the ratio of their evidences (Laplace's approximation; MacKay 1992, Neural Computation 4(3)), in which an
/// unknown that it adds costs what the data narrow its prior by. 0 where it has no usable fit, and for a richer one at
/// a bound, where it is the simpler one.
[[nodiscard]] double probability_against(const TriedStructure& other, const TriedStructure& taken);

/// A richer structure is taken where its probability against the one taken so far is larger than this.
inline constexpr double kProbable = 0.95;
/// And up to roll, which a plain bicycle must not be taken for, where it makes the data likelier by more than this (the
/// log of the likelihoods' ratio, divided by `inflation`): twice it is a chi-square of the added unknowns, of which 20
/// is exceeded by chance once in 2000 times (four unknowns).
inline constexpr double kLikelier = 10.0;
/// And predicts the hold-out no worse than by this, in the logarithm of all residuals together.
inline constexpr double kNoWorse = 0.02;

/// Which structure to take: from the simplest upward as long as a later one is probable enough, up to roll likelier
/// enough too, predicts no worse and has none of its own unknowns at a bound. The first where none is usable.
[[nodiscard]] std::size_t choose_structure(std::span<const TriedStructure> tried);

}  // namespace veridyn::vehicle
