#pragma once

#include <span>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"

namespace veridyn::vehicle {

/// An unknown of `kDriveBudget` of which a drive says what its prior all but excludes.
struct BudgetConflict {
  DriveUnknown unknown = {};
  double value = 0.0, sigma = 0.0;  ///< as the drive shows it, in the unit of the unknown
  double prior = 0.0;               ///< standard deviation that was expected
};

/// Those of a fit with the priors of `model`. The statistic is what an estimate is off its prior by over what it would
/// be off by chance, sqrt(prior^2 - sigma^2), the prior-predictive check of a normal mean (Evans & Moshonov 2006,
/// "Checking for prior-data conflict"); beyond three the two do not agree.
[[nodiscard]] std::vector<BudgetConflict> budget_conflicts(const DriveModelOptions& model,
                                                           const estimation::OutputErrorEstimate& fit);

/// The options with priors as wide as what the drive shows. A narrow prior that is wrong holds its unknown back by
/// much more than the standard error that it then states, and moves all others.
[[nodiscard]] DriveModelOptions with_widened_priors(DriveModelOptions model, std::span<const BudgetConflict> conflicts);

/// A row for each, that of the steering's delay apart, which has a check of its own.
[[nodiscard]] std::vector<estimation::Evidence> conflict_rows(std::span<const BudgetConflict> conflicts);

}  // namespace veridyn::vehicle
