#include "veridyn/aircraft/identification/evidence/sensor_doubt.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Parameter;
using estimation::ParameterStatus;

bool has_interval(const Parameter& p) {
  return p.status == ParameterStatus::kIdentified || p.status == ParameterStatus::kWeak;
}

}  // namespace

FlightSignals with_changed(FlightSignals signals, const SignalDoubt& doubt, double deviations) {
  for (double& v : signals[doubt.signal].value) v = v * (1.0 + deviations * doubt.scale) + deviations * doubt.zero;
  return signals;
}

Eigen::MatrixXd doubt_sensitivity(const FlightSignals& signals, std::span<const SignalDoubt> doubts,
                                  const Eigen::VectorXd& theta,
                                  const std::function<Eigen::VectorXd(const FlightSignals&)>& estimate) {
  // A tenth of a deviation: the tangent, also where the deviation is large.
  constexpr double kStep = 0.1;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(theta.size(), doubts.size());
  for (std::size_t i = 0; i < doubts.size(); ++i) {
    if (!signals[doubts[i].signal].available()) continue;
    const Eigen::VectorXd changed = estimate(with_changed(signals, doubts[i], kStep));
    if (changed.size() == theta.size()) columns.col(i) = (changed - theta) / kStep;
  }
  return columns;
}

estimation::Evidence doubt_row(const std::string& coefficient, std::span<const Parameter> parameters,
                               const Eigen::VectorXd& doubt) {
  const double limit = estimation::info_of(estimation::Check::kAirDataDoubt).tolerance.high;
  std::vector<std::string> named;
  double largest = 0.0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    const double d = doubt(i);
    if (!has_interval(p) || !(p.sigma > 0.0)) continue;
    largest = std::max(largest, d / p.sigma);
    if (d > limit * p.sigma) named.push_back(fmt::format("{} by {:.2g}", p.name, d));
  }
  estimation::Evidence row = row_of(estimation::Check::kAirDataDoubt, coefficient,
                                    estimation::passed_or(named.empty(), estimation::Outcome::kNotVerified));
  row.value = largest;
  row.limit = limit;
  return std::move(row).with("parameters", fmt::format("{}", fmt::join(named, ", ")));
}

std::vector<Parameter> weak_by_doubt(std::vector<Parameter> parameters, const Eigen::VectorXd& doubt) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    Parameter& p = parameters[i];
    const double half = numerics::kNormal95 * std::hypot(p.sigma, doubt(i));
    if (p.status == ParameterStatus::kIdentified && half > estimation::kWeakShare * std::abs(p.value))
      p.status = ParameterStatus::kWeak;
  }
  return parameters;
}

}  // namespace veridyn::aircraft
