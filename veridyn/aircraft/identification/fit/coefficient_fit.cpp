#include "veridyn/aircraft/identification/fit/coefficient_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/fit/coefficient_description.hpp"
#include "veridyn/aircraft/identification/fit/error_variance.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/agreement.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft::internal {
namespace {

using estimation::Method;
using estimation::RegressionComparison;
using estimation::RegressionData;
using estimation::RegressionEstimate;

/// The estimate by the given method, or the recommended one; null where there is none.
const RegressionEstimate* choose(const RegressionComparison& comparison, std::optional<Method> method) {
  const auto usable = [&](Method m) {
    const RegressionEstimate* estimate = comparison.find(m);
    return estimate != nullptr && estimate->usable() ? estimate : nullptr;
  };
  if (method) return usable(*method);
  if (const RegressionEstimate* best = comparison.best()) return best;
  // What it would have been, so that the report can show it with the reason for its rejection.
  for (const Method fallback : {Method::kPcaGtls, Method::kGtls, Method::kOls}) {
    if (const RegressionEstimate* estimate = usable(fallback)) return estimate;
  }
  return nullptr;
}

/// The derivatives of a model. Constants hold the trim and zeros of sensors, which drift: that parts of a flight differ
/// in them refuses no derivative.
std::vector<Eigen::Index> derivatives_of(const CoefficientModel& model) {
  std::vector<Eigen::Index> derivatives;
  for (std::size_t i = 0; i < model.size(); ++i)
    if (!model.terms[i].constant() || model.size() == 1) derivatives.push_back(signed_index(i));
  return derivatives;
}

/// Of two independent estimates of the same derivatives.
estimation::Agreement agreement_of(const CoefficientModel& model, const RegressionEstimate& a,
                                   const RegressionEstimate& b) {
  const std::vector<Eigen::Index> derivatives = derivatives_of(model);
  return estimation::agreement((a.theta - b.theta)(derivatives),
                               (a.covariance + b.covariance)(derivatives, derivatives));
}

/// What the study gave for the terms of a model, where it gave all of them.
std::optional<Eigen::VectorXd> start_values(const CoefficientModel& model, const Subject& subject) {
  const CoefficientModel* given = subject.model.find(model.coefficient);
  if (given == nullptr) return std::nullopt;
  Eigen::VectorXd values(model.size());
  for (std::size_t i = 0; i < model.size(); ++i) values(i) = given->value_of(model.terms[i].expression).value_or(kNaN);
  return values.allFinite() ? std::optional(values) : std::nullopt;
}

/// The choice and its checks over several flights: of each check the flight in which it came out worst.
RegressionComparison worst_of(std::span<const CoefficientFit> fits, std::span<const PreparedFlight> flights,
                              RegressionComparison together) {
  together.checks.clear();
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i].comparison.recommends) continue;
    if (!together.recommends || together.checks.empty()) together.reason = fits[i].comparison.reason;
    together.recommends = true;
    for (estimation::Evidence row : fits[i].comparison.checks) {
      row.with("flight", flights[i].name);
      const auto same = std::ranges::find(together.checks, row.check, &estimation::Evidence::check);
      if (same == together.checks.end())
        together.checks.push_back(std::move(row));
      else if (row.outcome > same->outcome)
        *same = std::move(row);
    }
  }
  return together;
}

/// Rows of each flight and their weighted mean.
double over_rows(std::span<const CoefficientFit> fits, double CoefficientFit::*figure) {
  double sum = 0.0, rows = 0.0;
  for (const CoefficientFit& fit : fits) {
    if (!fit.chosen) continue;
    const auto count = static_cast<double>(fit.rows.data.rows());
    sum += count * (fit.*figure);
    rows += count;
  }
  return sum / rows;
}

/// The hold-out against the mean of flights that differ: within a flight that has both, its own two estimates
/// (chi-square of all such flights together); of a flight that is held out as a whole, its estimate against the mean,
/// which scatters as the others do (Student's t, the least p of a parameter times their number).
double agreement_beyond_scatter(const RegressionEstimate& mean, const FlightFits& each, const FlightRows& held_out,
                                const FlightView& view) {
  const Eigen::Index n = mean.theta.size();
  double chi_square = 0.0, freedom = 0.0, least = 1.0;
  for (std::size_t i = 0; i < view.flights.size(); ++i) {
    if (held_out.rows_of(i) < 10 * n) continue;
    RegressionData unseen = held_out.of(i);
    unseen.error_covariance(n, n) = equation_error(unseen).variance;
    const RegressionEstimate again = estimation::estimate(unseen, mean.method, view.regression_options());
    if (!again.usable()) continue;
    if (each.fits[i].rows.data.rows() > 0) {
      if (!each.fits[i].chosen) continue;
      const CoefficientFit& own = each.fits[i];
      const auto dimensions = static_cast<double>(derivatives_of(own.model).size());
      chi_square += dimensions * agreement_of(own.model, *own.chosen, again).ratio;
      freedom += dimensions;
      continue;
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      const double of_mean = std::pow(each.scatter.sigma(j), 2.0);
      const double variance = of_mean + std::pow(each.scatter.between_sigma(j), 2.0) + again.covariance(j, j);
      const double t = (mean.theta(j) - again.theta(j)) / std::sqrt(variance);
      const double p = numerics::student_t_two_sided_p(t, each.scatter.degrees_of_freedom());
      least = std::min(least, p * static_cast<double>(n));
    }
  }
  return freedom > 0.0 ? std::min(least, numerics::chi_square_upper_p(chi_square, freedom)) : least;
}

}  // namespace

CoefficientFit fit_coefficient(CoefficientModel model, const FlightView& view) {
  CoefficientFit fit;
  fit.model = std::move(model);
  fit.rows = view.rows(fit.model, RowUse::kIdentification);
  RegressionData& data = fit.rows.data;
  fit.enough_rows = data.rows() >= static_cast<Eigen::Index>(10 * fit.model.size());
  if (!fit.enough_rows) return fit;
  const auto n = data.parameters();
  const RegressionData by_sensors = data;
  const EquationError error = equation_error(data);
  data.error_covariance(n, n) = error.variance;
  fit.error_ratio = error.ratio;
  fit.comparison = estimation::compare(data, view.regression_options());
  if (const RegressionEstimate* chosen = choose(fit.comparison, view.options.method)) {
    fit.chosen = *chosen;
    fit.of_rows = chosen->theta;
    // The errors of the regressors explain all: then the residual is compared with theirs and the sensors' of z.
    if (!(fit.error_ratio > 0.0)) fit.error_ratio = residual_ratio(by_sensors, chosen->theta);
    for (std::size_t i = 0; i < fit.model.size(); ++i) fit.model.values[i] = chosen->theta(i);
    fit.unmodelled_share = unmodelled_share_of(fit);
  }
  return fit;
}

FlightFits fit_each_flight(CoefficientFit& fit, const FlightView& view) {
  FlightFits each;
  std::vector<RegressionEstimate> estimates;
  for (std::size_t i = 0; i < view.flights.size(); ++i) {
    each.fits.push_back(fit_coefficient(fit.model, {view.flights.subspan(i, 1), view.subject, view.options}));
    const CoefficientFit& one = each.fits.back();
    if (one.rows.data.rows() == 0) continue;
    const bool agreed = one.chosen && (one.comparison.recommends || view.options.method);
    estimates.push_back(agreed ? *one.chosen : RegressionEstimate{});
  }
  each.scatter = estimation::group_scatter(estimates);
  if (!fit.chosen || !each.scatter.found()) return each;
  estimation::take_mean(*fit.chosen, each.scatter, view.options.significance);
  for (std::size_t i = 0; i < fit.model.size(); ++i) fit.model.values[i] = each.scatter.mean(i);
  fit.comparison = worst_of(each.fits, view.flights, std::move(fit.comparison));
  fit.error_ratio = over_rows(each.fits, &CoefficientFit::error_ratio);
  fit.unmodelled_share = over_rows(each.fits, &CoefficientFit::unmodelled_share);
  return each;
}

double unmodelled_share_of(const CoefficientFit& fit) {
  const double r2 = fit_on(fit.rows.data, fit.chosen->theta).r2;
  return (1.0 - r2) * std::max(0.0, 1.0 - estimation::kNoiseKnownTo / fit.error_ratio);
}

CoefficientChecks check_fit(const CoefficientFit& fit, double row_interval_s, const FlightFits* each,
                            const FlightView& view) {
  const RegressionEstimate& chosen = *fit.chosen;
  CoefficientChecks checks;
  checks.error_ratio = fit.error_ratio;
  checks.identification_fit = fit_on(fit.rows.data, chosen.theta);
  checks.unmodelled_share = fit.unmodelled_share;
  const RegressionData& data = fit.rows.data;
  const Eigen::VectorXd residual = data.regressand - data.regressors * chosen.theta;
  const auto lags = static_cast<std::size_t>(std::clamp(3.0 / row_interval_s, 10.0, 200.0));
  checks.residual_autocorrelation =
      numerics::autocorrelation({residual.data(), static_cast<std::size_t>(residual.size())}, lags, data.segment);

  const FlightRows held_out = view.rows(fit.model, RowUse::kHoldout);
  RegressionData unseen = held_out.data;
  checks.has_holdout = unseen.rows() >= static_cast<Eigen::Index>(10 * fit.model.size());
  if (!checks.has_holdout) return checks;
  checks.holdout_fit = fit_on(unseen, chosen.theta);
  checks.flight_fits = fits_by_flight(held_out, view.flights, chosen.theta);
  const double band = numerics::kNormal95 * std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
  const Eigen::ArrayXd missed = (unseen.regressand - unseen.regressors * chosen.theta).array().abs();
  checks.outside_bands = static_cast<double>((missed > band).count()) / static_cast<double>(missed.size());
  if (const std::optional<Eigen::VectorXd> start = start_values(fit.model, view.subject))
    checks.error_over_start = checks.holdout_fit.rmse / fit_on(unseen, *start).rmse;
  const auto n = unseen.parameters();
  checks.holdout_ratio = residual_ratio(unseen, chosen.theta);
  if (each != nullptr && each->scatter.found()) {
    checks.contradiction_p = agreement_beyond_scatter(chosen, *each, held_out, view);
    return checks;
  }
  // In another part of the flight the regressors may share more of their errors with z than that.
  unseen.error_covariance(n, n) =
      std::max(data.error_covariance(n, n), least_response_variance(unseen.error_covariance));
  const RegressionEstimate again = fit.by_output_error
                                       ? fit.of_holdout.value_or(RegressionEstimate{})
                                       : estimation::estimate(unseen, chosen.method, view.regression_options());
  checks.contradiction_p = kNaN;
  if (again.usable()) {
    const estimation::Agreement agreement = agreement_of(fit.model, chosen, again);
    checks.contradiction_p = agreement.p;
    checks.scatter = agreement.ratio;
  }
  return checks;
}

}  // namespace veridyn::aircraft::internal
