#include "veridyn/aircraft/identification/evidence/sensor_doubt.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

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
  constexpr double kLimit = 1.0;
  std::vector<std::string> named;
  double largest = 0.0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    const double d = doubt(i);
    if (!has_interval(p) || !(p.sigma > 0.0)) continue;
    largest = std::max(largest, d / p.sigma);
    if (d > kLimit * p.sigma) named.push_back(fmt::format("{} by {:.2g}", p.name, d));
  }
  const bool passed = named.empty();
  return {.name = "doubt of the air data",
          .about = coefficient,
          .outcome = estimation::passed_or(passed, estimation::Outcome::kNotVerified),
          .value = largest,
          .limit = kLimit,
          .scale = "doubt over standard error",
          .text = passed ? std::string("what this recording leaves in doubt of airspeed and vanes is within the "
                                       "standard errors")
                         : fmt::format("intervals take airspeed and vanes as right; as far as this recording verifies "
                                       "these, there is a doubt (one standard deviation) of {}",
                                       fmt::join(named, ", ")),
          .bears_on = estimation::Purpose::kParameters,
          .advice = passed ? std::string()
                           : std::string("calibrate pitot tube and vanes, or fly full circles and sharp doublets in "
                                         "calm air")};
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
