#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

namespace veridyn::aircraft {
namespace internal {

std::vector<FlightSignal> needed_signals(const CoefficientModel& model) {
  std::vector<FlightSignal> needed{FlightSignal::kAirspeed};
  const auto uses = [&](AeroVariable v) {
    return std::any_of(model.terms.begin(), model.terms.end(), [&](const Term& t) { return t.uses(v); });
  };
  if (uses(AeroVariable::kAlpha)) needed.push_back(FlightSignal::kAlpha);
  if (uses(AeroVariable::kBeta)) needed.push_back(FlightSignal::kBeta);
  if (uses(AeroVariable::kDe)) needed.push_back(FlightSignal::kElevator);
  if (uses(AeroVariable::kDa)) needed.push_back(FlightSignal::kAileron);
  if (uses(AeroVariable::kDr)) needed.push_back(FlightSignal::kRudder);
  if (uses(AeroVariable::kCT)) needed.push_back(FlightSignal::kThrust);
  if (model.coefficient == Coefficient::kCL || model.coefficient == Coefficient::kCD)
    needed.insert(needed.end(), {FlightSignal::kAlpha, FlightSignal::kAx, FlightSignal::kAz});
  if (model.coefficient == Coefficient::kCY) needed.push_back(FlightSignal::kAy);
  return needed;
}

bool complete(const FlightSample<double>& sample, const std::vector<FlightSignal>& needed) {
  return std::all_of(needed.begin(), needed.end(), [&](FlightSignal s) { return std::isfinite(sample[s]); });
}

}  // namespace internal

namespace {

using estimation::RegressionData;
using internal::complete;
using internal::needed_signals;

/// Rows on which the error covariance is averaged: the Jacobian varies slowly.
constexpr std::size_t kCovarianceRows = 2000;

}  // namespace

void internal::take_out_jumps(const CoefficientModel& model, const FlightSignals& signals,
                              const std::vector<std::size_t>& rows, RegressionData& data) {
  const std::vector<FlightSignal> needed = needed_signals(model);
  const std::size_t half = signals.jump_response.size() / 2;
  std::vector<Eigen::VectorXd> impulses;
  for (const DeflectionJump& jump : signals.jumps) {
    if (std::ranges::find(needed, jump.control) == needed.end()) continue;
    Eigen::VectorXd impulse = Eigen::VectorXd::Zero(data.rows());
    const std::size_t first = jump.after > half ? jump.after - half : 0;
    for (auto row = std::ranges::lower_bound(rows, first); row != rows.end() && *row + half < jump.after + 2 * half;
         ++row)
      impulse(row - rows.begin()) = signals.jump_response[*row + half - jump.after];
    if (impulse.squaredNorm() > 0.0) impulses.push_back(std::move(impulse));
  }
  const auto count = signed_index(impulses.size());
  // As many unknowns as that would take the parameters' information with them.
  constexpr Eigen::Index kRowsAJump = 10;
  if (count == 0 || kRowsAJump * count > data.rows()) return;
  Eigen::MatrixXd nuisance(data.rows(), count);
  for (Eigen::Index j = 0; j < count; ++j) nuisance.col(j) = impulses[at(j)];
  Eigen::MatrixXd columns(data.rows(), data.parameters() + 1);
  columns << data.regressors, data.regressand;
  columns -= nuisance * numerics::shortest_least_squares(nuisance, columns);
  data.regressors = columns.leftCols(data.parameters());
  data.regressand = columns.rightCols(1);
}
std::string identification_obstacle(const CoefficientModel& model, const FlightSignals& signals,
                                    const Subject& subject) {
  const std::string name = regressed_name(model.coefficient, subject);
  if (model.coefficient == Coefficient::kCD && !signals[FlightSignal::kThrust].available()) {
    return "CD needs the thrust: a channel, or throttle with a propulsion model in the subject";
  }
  for (const FlightSignal signal : needed_signals(model)) {
    if (!signals[signal].available()) {
      return fmt::format("{} needs {}, which the log does not have", name, kFlightSignalNames[signal]);
    }
  }
  return {};
}

Axis axis_of(Coefficient coefficient) {
  const bool longitudinal =
      coefficient == Coefficient::kCL || coefficient == Coefficient::kCD || coefficient == Coefficient::kCm;
  return longitudinal ? Axis::kLongitudinal : Axis::kLateral;
}

Eigen::MatrixXd row_error_covariance(const CoefficientModel& model, const FlightSignals& signals, std::size_t k,
                                     const Subject& subject) {
  const auto n = signed_index(model.size());
  Eigen::VectorXd classical = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kFlightSignals));
  Eigen::VectorXd berkson = classical;
  for (std::size_t i = 0; i < kFlightSignals; ++i) {
    const GridSignal& signal = signals.signals[i];
    const double variance = signal.sigma * signal.sigma;
    if (signal.error == ErrorKind::kClassical) classical(static_cast<Eigen::Index>(i)) = variance;
    if (signal.error == ErrorKind::kBerkson) berkson(static_cast<Eigen::Index>(i)) = variance;
  }
  CoefficientRow row = coefficient_row(model, signals.sample(k), subject, signals.air_density[k]);
  // A thrust that was computed from the airspeed has its error.
  if (!signals.thrust_per_airspeed.empty()) {
    row.jacobian.col(static_cast<Eigen::Index>(FlightSignal::kAirspeed)) +=
        signals.thrust_per_airspeed[k] * row.jacobian.col(static_cast<Eigen::Index>(FlightSignal::kThrust));
  }
  Eigen::MatrixXd W = row.jacobian * classical.asDiagonal() * row.jacobian.transpose();
  W(n, n) += row.jacobian.row(n).cwiseAbs2().dot(berkson);
  // Where the aircraft rolls with a gust, it does not roll against the air; the rolling itself is as recorded.
  const Eigen::VectorXd by_roll = row.jacobian.col(static_cast<Eigen::Index>(FlightSignal::kP)).head(n);
  W.topLeftCorner(n, n) += signals.air_rates.error_of_roll() * by_roll * by_roll.transpose();
  return W;
}

std::vector<Term> default_candidates(const CoefficientModel& model) {
  std::vector<Term> terms = model.terms;
  std::vector<const char*> usual{"1",          "beta",      "p_n",       "r_n",      "da",       "dr",
                                 "alpha*beta", "alpha*p_n", "alpha*r_n", "alpha*da", "alpha*dr", "beta^3"};
  if (axis_of(model.coefficient) == Axis::kLongitudinal)
    usual = {"1", "alpha", "q_n", "de", "alpha^2", "alpha*q_n", "alpha*de", "de^2"};
  for (const char* text : usual) {
    Term term = parse_term(text, "candidates");
    if (std::find(terms.begin(), terms.end(), term) == terms.end()) terms.push_back(std::move(term));
  }
  return terms;
}

RegressionData coefficient_data(const CoefficientModel& model, const FlightSignals& signals,
                                std::span<const TimeSpan> spans, const Subject& subject,
                                const Eigen::MatrixXd* errors) {
  const std::vector<FlightSignal> needed = needed_signals(model);
  const auto n = signed_index(model.size());
  std::vector<std::size_t> rows;
  std::vector<int> segment;
  int id = 0;
  for (const TimeSpan& span : spans) {
    const auto [begin, end] = signals.indices(span);
    ++id;
    for (std::size_t k = begin; k < end; k += signals.stride) {
      if (!complete(signals.sample(k), needed)) continue;
      // No lag and no transform is formed across a hole.
      if (!rows.empty() && segment.back() == id && rows.back() + signals.stride != k) ++id;
      rows.push_back(k);
      segment.push_back(id);
    }
  }
  RegressionData data;
  data.regressand_name = regressed_name(model.coefficient, subject);
  for (const Term& term : model.terms) {
    data.parameter_names.push_back(regressed_parameter_name(model.coefficient, term, subject));
    data.parameter_units.push_back(regressed_parameter_unit(model.coefficient, term, subject));
  }
  data.segment = std::move(segment);
  const auto count = signed_index(rows.size());
  data.regressors.resize(count, n);
  data.regressand.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t k = rows[at(i)];
    const FlightSample<double> sample = signals.sample(k);
    const double rho = signals.air_density[k];
    const double torque = signals.torque.empty() ? 0.0 : signals.torque[k];
    data.regressors.row(i) = model.regressors(aero_variables(signals.sample_in_air(k), subject, rho)).transpose();
    data.regressand(i) = select(regressed_coefficients(sample, subject, rho, torque), model.coefficient);
  }
  if (count == 0) return data;
  internal::take_out_jumps(model, signals, rows, data);
  if (errors != nullptr) {
    data.error_covariance = *errors;
    return data;
  }

  // The Jacobian varies slowly: a mean over some of the rows.
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(n + 1, n + 1);
  const std::size_t step = std::max<std::size_t>(1, rows.size() / kCovarianceRows);
  std::size_t used = 0;
  for (std::size_t i = 0; i < rows.size(); i += step) {
    W += row_error_covariance(model, signals, rows[i], subject);
    ++used;
  }
  data.error_covariance = W / static_cast<double>(used);
  return data;
}

}  // namespace veridyn::aircraft
