#pragma once

#include <span>
#include <vector>

#include "veridyn/aircraft/identification/fit/coefficient_result.hpp"
#include "veridyn/aircraft/identification/rows/flight_rows.hpp"
#include "veridyn/numerics/statistics.hpp"

/// Inside of identification: what identifying a coefficient and trying a given one say of it in the same way.
namespace veridyn::aircraft::internal {

/// What is known of a coefficient before anything is estimated; `reason` is empty unless nothing can be.
[[nodiscard]] CoefficientResult described(const CoefficientModel& model, std::span<const PreparedFlight> flights,
                                          const Subject& subject);

/// Predicted and measured coefficient over rows.
[[nodiscard]] numerics::FitMeasures fit_on(const estimation::RegressionData& data, const Eigen::VectorXd& theta);

/// The same over the rows of each flight that has some; empty where there is only one flight.
[[nodiscard]] std::vector<FlightFit> fits_by_flight(const FlightRows& rows, std::span<const PreparedFlight> flights,
                                                    const Eigen::VectorXd& theta);

/// With the measured and modelled coefficient of `result.model` while airborne; see CoefficientResult.
[[nodiscard]] CoefficientResult with_series(CoefficientResult result, std::span<const PreparedFlight> flights,
                                            const Subject& subject);

}  // namespace veridyn::aircraft::internal
