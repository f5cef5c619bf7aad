#pragma once

#include <optional>
#include <span>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"

namespace veridyn::vehicle {

/// A delay of `kDriveBudget` of which a drive says what its prior all but excludes. Of a place or of tyres it is none:
/// beyond their priors they stand for what the model lacks, and a wider prior would let them take more of it (a car
/// that rolls had its accelerometer 1.7 m behind, and C_f at twice its value).
struct BudgetConflict {
  DriveUnknown unknown = {};
  double value = 0.0, sigma = 0.0;  ///< as the drive shows it, in the unit of the unknown
  double mean = 0.0, prior = 0.0;   ///< what was expected, and its standard deviation
  double by_chance = 0.0;           ///< standard deviation of the value, were the prior right
};

/// Those of a fit with the priors of `model`. The statistic is what an estimate is off its prior by over what it would
/// be off by chance, sqrt(prior^2 - sigma^2), the prior-predictive check of a normal mean (Evans & Moshonov 2006,
/// "Checking for prior-data conflict"); beyond three the two do not agree.
[[nodiscard]] std::vector<BudgetConflict> budget_conflicts(const DriveModelOptions& model,
                                                           const estimation::OutputErrorEstimate& fit);

/// The one that is least likely by chance; nothing where there is none. Others may follow from it.
[[nodiscard]] std::optional<BudgetConflict> strongest(std::span<const BudgetConflict> conflicts);

/// The options with a prior of this unknown twice as wide as what the drive shows. A narrow prior that is wrong holds
/// its unknown back by much more than the standard error that it then states, and moves all others.
[[nodiscard]] DriveModelOptions with_widened_prior(DriveModelOptions model, const BudgetConflict& conflict);

/// What became of conflicts whose priors were widened, one after the other, and what is left: `widened` with the values
/// of the last fit, and its own conflicts.
[[nodiscard]] std::vector<BudgetConflict> conflicts_now(std::vector<BudgetConflict> widened,
                                                        const DriveModelOptions& model,
                                                        const estimation::OutputErrorEstimate& fit);

/// A row for each, that of the steering's delay apart, which has a check of its own.
[[nodiscard]] std::vector<estimation::Evidence> conflict_rows(std::span<const BudgetConflict> conflicts);

}  // namespace veridyn::vehicle
