#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/identification.hpp"
#include "veridyn/aircraft/identification/other_estimators.hpp"
#include "veridyn/aircraft/identification/validation/validation.hpp"
#include "veridyn/estimation/result/analysis.hpp"

/// The results of an aircraft's coefficients in the terms that all domains share, as reports, tables and console read
/// them.
namespace veridyn::aircraft {

/// A group for each coefficient: its regressions, the other estimators and its checks.
[[nodiscard]] std::vector<estimation::ParameterGroup> parameter_groups(std::span<const CoefficientResult> results,
                                                                       const OtherEstimators& others);

/// Values of a simulated aircraft's parameters by the names that they are estimated under.
[[nodiscard]] std::map<std::string, double, std::less<>> true_values(const Subject& truth, const Subject& subject,
                                                                     std::span<const CoefficientResult> results);

/// The quantities that were simulated and the coefficients, as predicted on the hold-out.
[[nodiscard]] std::vector<estimation::PredictedQuantity> predictions(std::span<const PredictedQuantity> simulated,
                                                                     std::span<const CoefficientResult> results);

}  // namespace veridyn::aircraft
