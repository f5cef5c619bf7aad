#pragma once

#include <string>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/recursive/regression_tracker.hpp"

namespace veridyn::estimation {

/// What a tracked regression is judged by, all over its memory: residual against the sensors' noise (normalised
/// chi-square, and the share of the variance that is neither modelled nor noise), residual autocorrelation,
/// collinearity, directions that are held, agreement of estimates a memory apart, standard errors that are none,
/// changes that were found, and the share of the next rows that is predicted.
/// @param about what the rows are about: "Cm"
/// @param estimate the tracker's, as `RegressionTracker::estimate`
[[nodiscard]] std::vector<Evidence> tracking_evidence(const std::string& about, const RegressionTracker& tracker,
                                                      const RegressionEstimate& estimate);

}  // namespace veridyn::estimation
