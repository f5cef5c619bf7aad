#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/identification/options/drive_structure.hpp"

namespace veridyn::vehicle {

/// One structure that was fitted to the identification segments and validated on the hold-out.
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

/// Probability of a structure against another, both as likely before the data: the ratio of their evidences (Laplace's
/// approximation; MacKay 1992, Neural Computation 4(3)), in which an unknown that it adds costs what the data narrow
/// its prior by. 0 where it has no usable fit, and for a richer one at a bound, where it is the simpler one.
[[nodiscard]] double probability_against(const TriedStructure& other, const TriedStructure& taken);

/// A richer structure is taken where its probability against the one taken so far is larger than this; tyres that lag
/// beside roll, as all do, unless that of tyres that do not is: a lag left out passes for a delay of the steering.
inline constexpr double kProbable = 0.95;
/// And up to roll, which a plain bicycle must not be taken for, where it makes the data likelier by more than this (the
/// log of the likelihoods' ratio, divided by `inflation`): twice it is a chi-square of the added unknowns, of which 10
/// is exceeded by chance once in 25 times (four unknowns).
inline constexpr double kLikelier = 5.0;
/// And predicts the hold-out no worse than by this, in the logarithm of all residuals together.
inline constexpr double kNoWorse = 0.02;

/// Which structure to take: from the simplest upward as long as a later one is probable enough, up to roll likelier
/// enough too, predicts no worse and has none of its own unknowns at a bound. The first where none is usable.
[[nodiscard]] std::size_t choose_structure(std::span<const TriedStructure> tried);

}  // namespace veridyn::vehicle
