#include "veridyn/aircraft/identification/fit/sensor_width.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {

using estimation::Parameter;
using estimation::ParameterStatus;

Eigen::MatrixXd sensor_sensitivity(const FlightSignals& signals, const SensorBudget& budget, Coefficient coefficient,
                                   const Eigen::VectorXd& theta,
                                   const std::function<Eigen::VectorXd(const FlightSignals&)>& estimate) {
  // A tenth of a deviation: the tangent, also where the deviation is large.
  constexpr double kStep = 0.1;
  const std::vector<SensorError>& errors = budget.errors;
  Eigen::MatrixXd changes = Eigen::MatrixXd::Zero(theta.size(), signed_index(errors.size()));
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const SensorError& error = errors[i];
    if (!(error.sigma > 0.0) || !rests_on(coefficient, error.sensor)) continue;
    // A variance cannot become less than none.
    const double step = error.kind == SensorErrorKind::kGustRoll ? -kStep : kStep;
    const Eigen::VectorXd changed = estimate(with_error(signals, error.sensor, error.kind, step * error.sigma));
    if (changed.size() == theta.size()) changes.col(signed_index(i)) = (changed - theta) / step;
  }
  changes *= root_of_correlation(budget);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(theta.size(), kSensorErrors);
  for (std::size_t i = 0; i < errors.size(); ++i)
    columns.col(signed_index(place_of(errors[i]))) += changes.col(signed_index(i));
  return columns;
}

IntervalParts interval_parts(const Eigen::VectorXd& noise, const Eigen::MatrixXd& sensors,
                             const Eigen::MatrixXd& body) {
  using enum SensorErrorKind;
  Eigen::VectorXd air_data = Eigen::VectorXd::Zero(noise.size()), delays = air_data;
  Eigen::VectorXd own = body.rowwise().squaredNorm();
  for (const BudgetSensor sensor : enumerators<BudgetSensor, kBudgetSensors>()) {
    for (const SensorErrorKind kind : enumerators<SensorErrorKind, kSensorErrorKinds>()) {
      const auto column = sensors.col(signed_index(place_of({.sensor = sensor, .kind = kind})));
      const bool place = kind == kPlaceX || kind == kPlaceY || kind == kPlaceZ;
      (kind == kDelay || kind == kLag ? delays : place ? own : air_data) += column.cwiseAbs2();
    }
  }
  return {.noise = noise, .air_data = air_data.cwiseSqrt(), .delays = delays.cwiseSqrt(), .body = own.cwiseSqrt()};
}

estimation::Evidence sensor_share_row(const std::string& coefficient, std::span<const Parameter> parameters,
                                      const IntervalParts& parts) {
  const double limit = estimation::info_of(estimation::Check::kSensorShare).tolerance.high;
  std::vector<std::string> named;
  double largest = 0.0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    const auto at = static_cast<Eigen::Index>(i);
    if ((p.status != ParameterStatus::kIdentified && p.status != ParameterStatus::kWeak) || !(p.sigma > 0.0)) continue;
    const double share = (std::pow(parts.air_data(at), 2.0) + std::pow(parts.delays(at), 2.0)) / (p.sigma * p.sigma);
    largest = std::max(largest, share);
    if (share > limit) named.push_back(fmt::format("{} {:.0f} %", p.name, 100.0 * share));
  }
  estimation::Evidence row = row_of(estimation::Check::kSensorShare, coefficient,
                                    estimation::passed_or(named.empty(), estimation::Outcome::kNotVerified));
  row.value = largest;
  row.limit = limit;
  return std::move(row).with("parameters", fmt::format("{}", fmt::join(named, ", ")));
}

}  // namespace veridyn::aircraft
