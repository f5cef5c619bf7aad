#include "veridyn/aircraft/identification/fit/gust_share.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "veridyn/aircraft/identification/fit/error_variance.hpp"
#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"
#include "veridyn/aircraft/simulation/gust_gradients.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::RegressionData;
using estimation::RegressionEstimate;

struct Share {
  double value, sigma;
};

constexpr double kOfHandbook1797 = 2.6;
/// Standard deviation of the noise that the sensors leave in a rolling moment, of its variance: to a factor of two.
constexpr double kNoiseKnownTo = 0.5;
/// Lengths by MIL-F-8785C and MIL-HDBK-1797 differ by two, and more than the roll mode answers p_g. Of what it answers.
constexpr double kAnswerKnownTo = 0.6;

/// Noise of the reconstructed gusts is in the column of the share.
constexpr double kWidened = 2.0;

/// Of q_g by the pitching moment, of r_g by the yawing moment.
std::optional<Share> turn_share(const CoefficientModel& model, const PreparedFlight& flight, const Subject& subject) {
  if (!identification_obstacle(model, flight.signals, subject).empty()) return std::nullopt;
  const std::vector<TimeSpan>& spans = flight.segments.of(axis_of(model.coefficient)).excited;
  FlightSignals turned = flight.signals;
  (model.coefficient == Coefficient::kCm ? turned.air_rates.pitch_share : turned.air_rates.yaw_share) += 1.0;
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

/// Rows of the rolling moment over the lateral manoeuvres; without rows where it cannot be regressed.
RegressionData rolling_rows(const FlightSignals& signals, const PreparedFlight& flight, const Subject& subject) {
  const CoefficientModel* model = subject.model.find(Coefficient::kCl);
  if (model == nullptr || !identification_obstacle(*model, signals, subject).empty()) return {};
  RegressionData data = coefficient_data(*model, signals, flight.segments.lateral.excited, subject);
  return data.rows() < 20 * data.parameters() ? RegressionData{} : data;
}

/// Of p_g by the rolling moment: what it has beyond the noise of the sensors is Cl_p p_g.
std::optional<SensorError> measured_roll(const SensorError& prior, const PreparedFlight& flight,
                                         const Subject& subject) {
  constexpr double kLargestShare = 2.0;
  /// Of the variance of p that the other regressors leave, at most taken off: at a quarter p counts as not excited.
  constexpr double kMostOfRoll = 0.2;
  const AirRates& air = flight.signals.air_rates;
  FlightSignals rolled = flight.signals;
  rolled.air_rates.roll_share += 1.0;
  RegressionData data = rolling_rows(flight.signals, flight, subject);
  if (data.rows() == 0) return std::nullopt;
  const Eigen::Index n = data.parameters();
  const Eigen::MatrixXd by_sensors = data.error_covariance;
  const Eigen::MatrixXd by_roll = rolling_rows(rolled, flight, subject).error_covariance - by_sensors;
  const double noise = by_sensors(n, n);
  // by_roll has one column: what of its own variance it takes, per share.
  const Eigen::MatrixXd moments = data.regressors.transpose() * data.regressors / static_cast<double>(data.rows());
  const numerics::Cholesky factor(moments);
  if (!factor.positive_definite()) return std::nullopt;
  const double taken = factor.solve(Eigen::MatrixXd(by_roll.topLeftCorner(n, n))).trace();
  const double most = kMostOfRoll / taken;
  double share = 0.0, sigma = kNaN;
  for (int iteration = 0; iteration < 4; ++iteration) {
    data.error_covariance = by_sensors + std::min(share, most) * by_roll;
    const double unexplained = equation_error(data).variance;
    data.error_covariance(n, n) = unexplained;
    const RegressionEstimate found = estimation::estimate(data, estimation::Method::kGtls);
    if (!found.usable()) return std::nullopt;
    const double whole = found.theta.dot(by_roll.topLeftCorner(n, n) * found.theta) * air.gust_roll / air.answered_roll;
    if (!(whole > 0.0)) return std::nullopt;
    share = std::clamp((unexplained - noise) / whole, 0.0, kLargestShare);
    sigma = kNoiseKnownTo * noise / whole;
  }
  SensorError roll = updated(prior, share, sigma);
  roll.sigma = std::hypot(roll.sigma, kAnswerKnownTo * roll.mean);
  roll.mean = std::min(roll.mean, most);
  return roll;
}

/// Means over some spans; NaN without samples.
struct MeanAir {
  double airspeed, density;
};

MeanAir mean_air(const FlightSignals& signals, std::span<const TimeSpan> spans) {
  double airspeed = 0.0, density = 0.0, count = 0.0;
  for (const TimeSpan& span : spans) {
    const auto [begin, end] = signals.indices(span);
    for (std::size_t k = begin; k < end; ++k) {
      const double V = signals[FlightSignal::kAirspeed].value[k];
      if (!std::isfinite(V)) continue;
      airspeed += V;
      density += signals.air_density[k];
      count += 1.0;
    }
  }
  return {airspeed / count, density / count};
}

/// Time constant with which a roll dies away, by a derivative Cl_p or Cl/Jx_p [s].
double roll_time(double Cl_p, const MeanAir& air, const Subject& subject) {
  const double inertia = subject.inertia ? subject.inertia->Jx : 1.0;
  return -4.0 * inertia /
         (air.density * air.airspeed * subject.wing_area * subject.roll_length() * subject.span * Cl_p);
}

}  // namespace

void know_gusts_across(PreparedFlight& flight, const Subject& subject) {
  FlightSignals& signals = flight.signals;
  const DrydenSettings& turbulence = flight.reconstruction.turbulence;
  const CoefficientModel* model = subject.model.find(Coefficient::kCl);
  if (model == nullptr || !(turbulence.sigma_w > 0.0) || !(subject.span > 0.0)) return;
  const auto by_p = std::ranges::find(model->terms, std::string("p_n"), &Term::expression);
  if (by_p == model->terms.end()) return;
  const MeanAir air = mean_air(signals, flight.segments.lateral.excited);
  // Between MIL-F-8785C, 4b/pi, and MIL-HDBK-1797, sqrt(L_w b)/2.6.
  const double length =
      std::sqrt(gust_roll_length(subject.span) * std::sqrt(turbulence.Lw * subject.span) / kOfHandbook1797);
  const double gust_time = length / air.airspeed, power = std::pow(gust_roll_sigma(turbulence, subject.span), 2.0);
  double answered = 0.0;
  for (int iteration = 0; iteration < 8; ++iteration) {
    FlightSignals rolled = signals;
    rolled.air_rates.answered_roll = answered;
    rolled.air_rates.roll_share = 1.0;
    RegressionData data = rolling_rows(rolled, flight, subject);
    if (data.rows() == 0) return;
    const Eigen::Index n = data.parameters();
    data.error_covariance(n, n) = equation_error(data).variance;
    const RegressionEstimate found = estimation::estimate(data, estimation::Method::kGtls);
    if (!found.usable()) break;
    const double tau = roll_time(found.theta(by_p - model->terms.begin()), air, subject);
    if (!(tau > 0.0)) break;
    answered = power * gust_time / (gust_time + tau);
  }
  signals.air_rates.gust_roll = power;
  signals.air_rates.answered_roll = answered;
}

std::vector<SensorError> air_errors(const PreparedFlight& flight, const Subject& subject, const KnownSensors& known) {
  using enum SensorErrorKind;
  const AirRates& air = flight.signals.air_rates;
  if (air.gust_q.empty()) return {};
  std::vector<SensorError> errors;
  for (const auto& [coefficient, kind] :
       {std::pair{Coefficient::kCm, kGustPitch}, std::pair{Coefficient::kCn, kGustYaw}}) {
    SensorError turn = prior_of(BudgetSensor::kAir, kind, known);
    const CoefficientModel* model = subject.model.find(coefficient);
    if (model != nullptr)
      if (const std::optional<Share> share = turn_share(*model, flight, subject))
        turn = updated(turn, share->value, share->sigma);
    errors.push_back(turn);
  }
  if (air.answered_roll > 0.0) {
    const SensorError prior = prior_of(BudgetSensor::kAir, kGustRoll, known);
    errors.push_back(measured_roll(prior, flight, subject).value_or(prior));
  }
  errors.push_back(prior_of(BudgetSensor::kAir, kDownwash, known));
  return errors;
}

}  // namespace veridyn::aircraft
