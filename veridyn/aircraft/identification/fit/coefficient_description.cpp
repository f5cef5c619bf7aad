#include "veridyn/aircraft/identification/fit/coefficient_description.hpp"

#include <algorithm>

#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft::internal {
namespace {

/// Between the rows of a segment: the same in all flights, which are on grids of one rate.
double row_interval_s(std::span<const PreparedFlight> flights) {
  const auto usable = std::ranges::find_if(flights, &PreparedFlight::usable);
  if (usable == flights.end()) return 0.0;
  return usable->signals.grid.step * static_cast<double>(usable->signals.stride);
}

}  // namespace

CoefficientResult described(const CoefficientModel& model, std::span<const PreparedFlight> flights,
                            const Subject& subject) {
  CoefficientResult result;
  result.coefficient = model.coefficient;
  result.name = regressed_name(model.coefficient, subject);
  result.per_unit_inertia = per_unit_inertia(model.coefficient, subject);
  result.axis = axis_of(model.coefficient);
  result.model = model;
  result.row_interval_s = row_interval_s(flights);
  result.reason = identification_obstacle(model, flights, subject);
  return result;
}

numerics::FitMeasures fit_on(const estimation::RegressionData& data, const Eigen::VectorXd& theta) {
  const Eigen::VectorXd model = data.regressors * theta;
  return numerics::fit_measures({data.regressand.data(), static_cast<std::size_t>(data.regressand.size())},
                                {model.data(), static_cast<std::size_t>(model.size())});
}

std::vector<FlightFit> fits_by_flight(const FlightRows& rows, std::span<const PreparedFlight> flights,
                                      const Eigen::VectorXd& theta) {
  std::vector<FlightFit> fits;
  if (flights.size() < 2) return fits;
  for (std::size_t i = 0; i < flights.size(); ++i)
    if (rows.rows_of(i) > 0) fits.push_back({flights[i].name, fit_on(rows.of(i), theta)});
  return fits;
}

CoefficientResult with_series(CoefficientResult result, std::span<const PreparedFlight> flights,
                              const Subject& subject) {
  const CoefficientModel& model = result.model;
  const std::vector<FlightSignal> needed = needed_signals(model);
  const bool estimated = model.known();
  for (const PreparedFlight& flight : flights) {
    const FlightSignals& signals = flight.signals;
    if (!flight.usable() || !identification_obstacle(model, signals, subject).empty()) continue;
    for (const TimeSpan& span : flight.segments.airborne) {
      const auto [begin, end] = signals.indices(span);
      for (std::size_t k = begin; k < end; k += signals.stride) {
        const FlightSample<double> sample = signals.sample(k);
        result.time.push_back(signals.grid.at(k) + flight.shift_s);
        if (!complete(sample, needed)) {
          result.measured.push_back(kNaN);
          result.modelled.push_back(kNaN);
          continue;
        }
        const double torque = signals.torque.empty() ? 0.0 : signals.torque[k];
        const double rho = signals.air_density[k];
        result.measured.push_back(select(regressed_coefficients(sample, subject, rho, torque), model.coefficient));
        result.modelled.push_back(estimated ? model.linear(aero_variables(signals.sample_in_air(k), subject, rho))
                                            : kNaN);
      }
    }
  }
  return result;
}

}  // namespace veridyn::aircraft::internal
