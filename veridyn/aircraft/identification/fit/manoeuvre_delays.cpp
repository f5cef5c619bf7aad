#include "veridyn/aircraft/identification/fit/manoeuvre_delays.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kStep_s = 0.005;       // of differences of the rows
constexpr double kInstrument_s = 0.05;  // from one lag to the next
constexpr std::size_t kInstrumentLags = 20;
constexpr double kCorrelated_s = 1.0;  // over which moments are summed
constexpr int kIterations = 8;
constexpr double kConverged_s = 2e-4;
/// Many instruments make errors larger than their standard errors (Bekker 1994): 2.0 times (root mean square) for the
/// vanes of 33 simulated flights, calm to moderate gusts. Of the variance.
constexpr double kManyInstruments = 4.0;
constexpr double kLongestStep_s = 0.02;  // what is linear at frequencies of a manoeuvre

/// A coefficient's columns [X, z] at grid points; NaN where a signal is missing.
Eigen::MatrixXd columns_of(const CoefficientModel& model, const FlightSignals& signals,
                           std::span<const std::size_t> places, const Subject& subject) {
  const std::vector<FlightSignal> needed = internal::needed_signals(model);
  Eigen::MatrixXd columns(signed_index(places.size()), signed_index(model.size()) + 1);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const std::size_t k = places[at(i)];
    const FlightSample<double> sample = signals.sample(k);
    if (!internal::complete(sample, needed)) {
      columns.row(i).setConstant(kNaN);
      continue;
    }
    const double rho = signals.air_density[k], torque = signals.torque.empty() ? 0.0 : signals.torque[k];
    columns.row(i).head(columns.cols() - 1) = model.regressors(aero_variables(sample, subject, rho)).transpose();
    columns(i, columns.cols() - 1) = select(regressed_coefficients(sample, subject, rho, torque), model.coefficient);
  }
  return columns;
}

/// Moments of a flight's axis at which rows are taken, and the instruments there.
struct Rows {
  std::vector<std::size_t> places;
  Eigen::MatrixXd instruments;
};

Rows rows_of(const FlightSignals& signals, const AxisSegments& axis, std::span<const FlightSignal> controls) {
  Rows rows;
  const auto lag = static_cast<std::size_t>(std::max(1.0, std::round(kInstrument_s / signals.grid.step)));
  const std::size_t reach = (kInstrumentLags - 1) * lag;
  for (const TimeSpan& span : axis.excited) {
    const auto [begin, end] = signals.indices(span);
    for (std::size_t k = std::max(begin, reach); k < end; k += signals.stride) {
      const auto known = [&](FlightSignal control) {
        const std::vector<double>& x = signals[control].value;
        for (std::size_t i = 0; i < kInstrumentLags; ++i)
          if (!std::isfinite(x[k - i * lag])) return false;
        return true;
      };
      if (std::ranges::all_of(controls, known)) rows.places.push_back(k);
    }
  }
  Eigen::MatrixXd all(signed_index(rows.places.size()), signed_index(controls.size() * kInstrumentLags) + 1);
  all.col(0).setOnes();
  for (std::size_t c = 0; c < controls.size(); ++c) {
    const std::vector<double>& x = signals[controls[c]].value;
    for (std::size_t i = 0; i < kInstrumentLags; ++i)
      for (Eigen::Index row = 0; row < all.rows(); ++row)
        all(row, signed_index(c * kInstrumentLags + i) + 1) = x[rows.places[at(row)] - i * lag];
  }
  rows.instruments = std::move(all);
  return rows;
}

/// The deflections of an axis that are recorded and not held.
std::vector<FlightSignal> moved_controls(const FlightSignals& signals, Axis axis) {
  constexpr double kLeastThrow = 0.2 * kDegree;
  std::vector<FlightSignal> controls;
  for (const FlightSignal control : {FlightSignal::kElevator, FlightSignal::kAileron, FlightSignal::kRudder}) {
    if ((control == FlightSignal::kElevator) != (axis == Axis::kLongitudinal)) continue;
    double low = kInfinity, high = -kInfinity;
    for (const double v : signals[control].value) {
      low = std::fmin(low, v);
      high = std::fmax(high, v);
    }
    if (high - low > kLeastThrow) controls.push_back(control);
  }
  return controls;
}

/// What one coefficient says of the delays: information and its product with the change that it asks for.
struct Information {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd vector;
  double misfit = 0.0;  ///< logarithm of the residual's variance
};

/// Long-run variance of u over its variance, at least 1.
double long_run_factor(const Eigen::VectorXd& u, Eigen::Index lags) {
  const double variance = u.squaredNorm();
  double sum = variance;
  for (Eigen::Index l = 1; l <= std::min(lags, u.size() - 1); ++l) {
    const double weight = 1.0 - static_cast<double>(l) / static_cast<double>(lags + 1);
    sum += 2.0 * weight * u.head(u.size() - l).dot(u.tail(u.size() - l));
  }
  return variance > 0.0 ? std::max(1.0, sum / variance) : 1.0;
}

/// Fewer rows than this for each instrument say nothing.
constexpr Eigen::Index kRowsAnInstrument = 5;

std::optional<Information> information_of(const CoefficientModel& model, const FlightSignals& signals,
                                          const std::vector<SensorError>& delays, const Rows& rows,
                                          const Subject& subject) {
  Eigen::MatrixXd base = columns_of(model, signals, rows.places, subject);
  const Eigen::Index n = base.cols() - 1, count = base.rows();
  std::vector<Eigen::MatrixXd> changes;
  Eigen::VectorXd missing = base.rowwise().sum();
  for (const SensorError& delay : delays) {
    const auto shifted = [&](double by) {
      return columns_of(model, with_error(signals, delay.sensor, delay.kind, by), rows.places, subject);
    };
    changes.emplace_back((shifted(kStep_s) - shifted(-kStep_s)) / (2.0 * kStep_s));
    missing += changes.back().rowwise().sum();
  }
  // A row without one of its values counts nothing.
  Eigen::MatrixXd W = rows.instruments;
  Eigen::Index used = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (std::isfinite(missing(i))) {
      ++used;
      continue;
    }
    base.row(i).setZero();
    W.row(i).setZero();
    for (Eigen::MatrixXd& change : changes) change.row(i).setZero();
  }
  if (used < kRowsAnInstrument * W.cols()) return std::nullopt;
  const Eigen::MatrixXd Q = numerics::HouseholderQr(W).thin_Q();
  const auto projected = [&](const Eigen::MatrixXd& columns) -> Eigen::MatrixXd {
    return Q * (Q.transpose() * columns);
  };
  const Eigen::MatrixXd X = base.leftCols(n), Xp = projected(X);
  const Eigen::VectorXd z = base.col(n);
  const Eigen::VectorXd theta = numerics::shortest_least_squares(Xp, Eigen::MatrixXd(z));
  Eigen::MatrixXd D(count, signed_index(delays.size()));
  for (std::size_t k = 0; k < delays.size(); ++k)
    D.col(signed_index(k)) = changes[k].leftCols(n) * theta - changes[k].col(n);
  const Eigen::MatrixXd Dp = projected(D);
  const Eigen::MatrixXd free = Dp - Xp * numerics::shortest_least_squares(Xp, Dp);
  const Eigen::VectorXd residual = z - X * theta;
  const auto lags =
      static_cast<Eigen::Index>(kCorrelated_s / (signals.grid.step * static_cast<double>(signals.stride)));
  double factor = 1.0;
  for (Eigen::Index k = 0; k < free.cols(); ++k)
    factor = std::max(factor, long_run_factor(free.col(k).cwiseProduct(residual), lags));
  const double white = residual.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, used - n));
  const double variance = kManyInstruments * factor * white;
  if (!(variance > 0.0)) return std::nullopt;
  // Noise of a vane is in the projected columns too, as much as there are instruments: it is no information.
  const auto spare = static_cast<double>(W.cols() - n);
  const Eigen::MatrixXd noise = (D - Dp).transpose() * (D - Dp) / static_cast<double>(used);
  numerics::SymmetricEigen axes = numerics::symmetric_eigen(free.transpose() * free - spare * noise);
  return Information{numerics::from_eigen(axes.vectors, axes.values.cwiseMax(0.0)) / variance,
                     free.transpose() * residual / variance, std::log(white)};
}

/// View of an axis's manoeuvres and what is known of the delays before.
struct Search {
  const FlightSignals& signals;
  const AxisSegments& axis;
  const Subject& subject;
  const std::vector<SensorError>& priors;
  const Rows& rows;
};

/// A step from where the means are.
struct Step {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd change;
  double misfit = 0.0;
};

std::optional<Step> step_from(const std::vector<SensorError>& errors, const Search& search) {
  const auto n = signed_index(errors.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd asked(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const SensorError& prior = search.priors[at(k)];
    information(k, k) = 1.0 / (prior.sigma * prior.sigma);
    asked(k) = information(k, k) * (prior.mean - errors[at(k)].mean);
  }
  const FlightSignals now = without_errors(search.signals, errors);
  double misfit = 0.0;
  for (const Coefficient c : enumerators<Coefficient, kCoefficients>()) {
    const CoefficientModel* model = search.subject.model.find(c);
    // Drag moves little with what the delays are of.
    if (model == nullptr || axis_of(c) != search.axis.axis || c == Coefficient::kCD ||
        !identification_obstacle(*model, now, search.subject).empty())
      continue;
    const std::optional<Information> more = information_of(*model, now, errors, search.rows, search.subject);
    if (!more) continue;
    information += more->matrix;
    // A signal that fits best with a further delay was recorded that much too early.
    asked -= more->vector;
    misfit += more->misfit;
  }
  const numerics::Cholesky factor(information);
  if (!information.allFinite() || !factor.positive_definite()) return std::nullopt;
  const Eigen::MatrixXd covariance = factor.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
  return Step{covariance, covariance * asked, misfit};
}

/// What a search found, and how badly it fits.
struct Found {
  ManoeuvreDelays delays;
  double misfit = kInfinity;
};

Found search_from(std::vector<SensorError> errors, const Search& search) {
  Found found;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const std::optional<Step> step = step_from(errors, search);
    if (!step) return found;
    found.misfit = step->misfit;
    found.delays.covariance = step->covariance;
    const double longest = step->change.cwiseAbs().maxCoeff();
    const double share = std::min(1.0, kLongestStep_s / std::max(longest, 1e-12));
    for (std::size_t k = 0; k < errors.size(); ++k) {
      errors[k].mean += share * step->change(signed_index(k));
      errors[k].sigma = std::sqrt(step->covariance(signed_index(k), signed_index(k)));
    }
    if (longest < kConverged_s) break;
  }
  found.delays.errors = std::move(errors);
  return found;
}

}  // namespace

ManoeuvreDelays delays_by_manoeuvres(const FlightSignals& signals, const AxisSegments& axis, const Subject& subject,
                                     std::vector<SensorError> priors, std::span<const SensorError> other_start) {
  std::erase_if(priors, [](const SensorError& prior) { return !(prior.sigma > 0.0); });
  ManoeuvreDelays before{.errors = priors, .covariance = {}};
  before.covariance.setZero(signed_index(priors.size()), signed_index(priors.size()));
  for (std::size_t k = 0; k < priors.size(); ++k)
    before.covariance(signed_index(k), signed_index(k)) = priors[k].sigma * priors[k].sigma;
  const std::vector<FlightSignal> controls = moved_controls(signals, axis.axis);
  if (priors.empty() || controls.empty()) return before;
  const Rows rows = rows_of(signals, axis, controls);
  const Search search{signals, axis, subject, priors, rows};
  Found found = search_from(priors, search);
  std::vector<SensorError> elsewhere = priors;
  bool differs = false;
  for (SensorError& error : elsewhere) {
    const auto other = std::ranges::find_if(
        other_start, [&](const SensorError& e) { return e.sensor == error.sensor && e.kind == error.kind; });
    if (other == other_start.end()) continue;
    differs = differs || std::abs(other->mean - error.mean) > kConverged_s;
    error.mean = other->mean;
  }
  if (differs)
    if (Found other = search_from(elsewhere, search); other.misfit < found.misfit) found = std::move(other);
  return std::isfinite(found.misfit) ? std::move(found.delays) : before;
}

}  // namespace veridyn::aircraft
