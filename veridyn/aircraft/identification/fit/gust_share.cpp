#include "veridyn/aircraft/identification/fit/gust_share.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::RegressionData;
using estimation::RegressionEstimate;

struct Share {
  double value, sigma;
};

/// Noise of the reconstructed gusts is in the column of the share.
constexpr double kWidened = 2.0;

std::optional<Share> turn_share(const CoefficientModel& model, const PreparedFlight& flight, const Subject& subject) {
  if (!identification_obstacle(model, flight.signals, subject).empty()) return std::nullopt;
  const std::vector<TimeSpan>& spans = flight.segments.of(axis_of(model.coefficient)).excited;
  FlightSignals turned = flight.signals;
  turned.air_rates.turn_share += 1.0;
  RegressionData data = coefficient_data(model, flight.signals, spans, subject);
  const Eigen::Index n = data.parameters();
  if (data.rows() < 20 * n) return std::nullopt;
  const Eigen::MatrixXd change = coefficient_data(model, turned, spans, subject).regressors - data.regressors;
  RegressionEstimate found = estimation::estimate(data, estimation::Method::kOls);
  if (!found.usable()) return std::nullopt;
  data.regressors.conservativeResize(Eigen::NoChange, n + 1);
  data.parameter_names.emplace_back("share");
  data.parameter_units.emplace_back("1");
  data.error_covariance.resize(0, 0);
  // The column holds the parameters of the rates, which are found with it.
  for (int iteration = 0; iteration < 3; ++iteration) {
    data.regressors.col(n) = change * found.theta.head(n);
    if (!(data.regressors.col(n).squaredNorm() > 0.0)) return std::nullopt;
    found = estimation::estimate(data, estimation::Method::kOls);
    if (!found.usable()) return std::nullopt;
  }
  // In calm air the reconstructed gusts are errors of sensors, of which any share may come out: by how much it cannot
  // be one, it is wrong.
  const double share = found.theta(n), impossible = share - std::clamp(share, 0.0, 1.0);
  if (std::abs(impossible) > 1.0) return std::nullopt;
  return Share{share, std::hypot(kWidened * std::sqrt(found.covariance(n, n)), impossible)};
}

}  // namespace

std::vector<SensorError> air_errors(const PreparedFlight& flight, const Subject& subject, const KnownSensors& known) {
  using enum SensorErrorKind;
  if (flight.signals.air_rates.gust_q.empty()) return {};
  SensorError turn = prior_of(BudgetSensor::kAir, kGustTurn, known);
  for (const Coefficient c : {Coefficient::kCm, Coefficient::kCn}) {
    const CoefficientModel* model = subject.model.find(c);
    if (model == nullptr) continue;
    if (const std::optional<Share> share = turn_share(*model, flight, subject))
      turn = updated(turn, share->value, share->sigma);
  }
  return {turn, prior_of(BudgetSensor::kAir, kDownwash, known)};
}

}  // namespace veridyn::aircraft
