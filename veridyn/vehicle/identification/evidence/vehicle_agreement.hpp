#pragma once

#include <optional>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/judgement/agreement.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimates.hpp"

namespace veridyn::vehicle {

/// The chosen method's estimates from the identification segments and from the hold-out, which are independent.
struct PartsAgreement {
  estimation::Agreement agreement;
  double largest_difference = 0.0;  ///< between the two, of any parameter, as a share of it
};

/// Estimates the vehicle's parameters from the hold-out alone, by the method that was chosen, and compares. Nothing
/// where there is no hold-out or it gives no estimate. `equation_error` and `output_error` may be null.
[[nodiscard]] std::optional<PartsAgreement> compare_parts(const VehicleProblem& problem, VehicleMethod chosen,
                                                          const EquationErrorEstimates* equation_error,
                                                          const OutputErrorResult* output_error, Progress& progress);

/// By how much variances grow: chi-square over its degrees of freedom, 1 where the error bars explain the scatter
/// (Birge 1932).
[[nodiscard]] double variance_factor(const std::optional<PartsAgreement>& parts);

/// The row of it. Parts that contradict each other by little are widened for; those that differ by more than a
/// twentieth are no constants.
[[nodiscard]] estimation::Evidence parts_row(const PartsAgreement& parts, double contradiction_level);

/// An estimate with covariance and intervals widened.
[[nodiscard]] VehicleEstimate widened(VehicleEstimate estimate, double factor, double significance);

}  // namespace veridyn::vehicle
