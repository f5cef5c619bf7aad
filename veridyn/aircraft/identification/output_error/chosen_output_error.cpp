#include "veridyn/aircraft/identification/output_error/chosen_output_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "veridyn/aircraft/identification/fit/coefficient_description.hpp"
#include "veridyn/aircraft/identification/fit/error_variance.hpp"
#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft::internal {
namespace {

using estimation::Check;
using estimation::Evidence;
using estimation::Parameter;
using estimation::ParameterStatus;
using estimation::RegressionEstimate;

std::vector<Eigen::Index> places_of(const CoefficientModel& model, const AxisOutputError& run) {
  std::vector<Eigen::Index> places;
  for (const std::string& name : model.parameter_names()) {
    const auto found = std::ranges::find(run.estimate.parameters, name, &Parameter::name);
    if (found == run.estimate.parameters.end()) return {};
    places.push_back(found - run.estimate.parameters.begin());
  }
  return places;
}

const AxisOutputError& run_of(std::span<const AxisOutputError> runs, Coefficient coefficient) {
  return *std::ranges::find(runs, axis_of(coefficient), &AxisOutputError::axis);
}

/// The part of a run that is of one coefficient, in the shape of its regression; nothing where it has none.
std::optional<RegressionEstimate> part_of(const AxisOutputError& run, const CoefficientFit& fit) {
  const std::vector<Eigen::Index> at =
      run.attempted && run.estimate.usable() ? places_of(fit.model, run) : std::vector<Eigen::Index>{};
  if (at.empty()) return std::nullopt;
  RegressionEstimate part = *fit.chosen;
  part.message = run.estimate.message;
  part.theta = run.estimate.theta(at);
  part.covariance = run.estimate.covariance(at, at);
  part.covariance_white = run.estimate.covariance_white(at, at);
  part.degrees_of_freedom = run.estimate.degrees_of_freedom;
  part.lag_window = run.estimate.lag_window;
  part.unexcited.clear();
  for (std::size_t j = 0; j < at.size(); ++j) {
    Parameter p = run.estimate.parameters[at[j]];
    p.variance_inflation = part.parameters[j].variance_inflation;  // of the motion, whatever the method
    part.parameters[j] = std::move(p);
  }
  const estimation::RegressionData& rows = fit.rows.data;
  const Eigen::VectorXd residual = rows.regressand - rows.regressors * part.theta;
  part.residual_sd = std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
  part.r_squared = fit_on(rows, part.theta).r2;
  return part;
}

/// Where the flights differ no method knows their mean better than their scatter does.
void widen_to_scatter(RegressionEstimate& part, const estimation::GroupScatter& scatter, double significance) {
  part.degrees_of_freedom = scatter.degrees_of_freedom();
  const Eigen::VectorXd sigma = part.covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd factor = scatter.sigma.cwiseQuotient(sigma).cwiseMax(1.0);
  part.covariance = factor.asDiagonal() * part.covariance * factor.asDiagonal();
  for (std::size_t j = 0; j < part.parameters.size(); ++j) {
    Parameter& p = part.parameters[j];
    p.sigma *= factor(j);
    estimation::set_interval(p, part.degrees_of_freedom);
    if (p.status == ParameterStatus::kIdentified && !(p.p_value < significance))
      p.status = ParameterStatus::kInsignificant;
  }
}

Evidence agreement_with_regression(const RegressionEstimate& part, const RegressionEstimate& regression) {
  double largest = 0.0;
  std::string which;
  for (std::size_t j = 0; j < part.parameters.size(); ++j) {
    const Parameter &a = part.parameters[j], &b = regression.parameters[j];
    const double apart = std::abs(a.value - b.value) / std::hypot(a.sigma, b.sigma);
    if (!(apart > largest)) continue;
    largest = apart;
    which = a.name;
  }
  return row_of(Check::kAgreesWithRegression, "", largest).with("parameter", which);
}

}  // namespace

ChosenOutputError fly_axes(std::span<const CoefficientModel> models, const FlightView& view, Progress& progress) {
  ChosenOutputError flown;
  for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral}) {
    std::vector<CoefficientModel> of_axis;
    std::ranges::copy_if(models, std::back_inserter(of_axis),
                         [&](const CoefficientModel& model) { return axis_of(model.coefficient) == axis; });
    AxisOutputError run =
        axis_output_error(axis, view.flights, RowUse::kIdentification, view.subject, of_axis, view.options, progress);
    if (run.estimate.usable()) {
      Eigen::Index next = 0;
      for (CoefficientModel& model : of_axis)
        for (double& value : model.values) value = run.estimate.theta(next++);
    }
    flown.holdout.push_back(
        axis_output_error(axis, view.flights, RowUse::kHoldout, view.subject, of_axis, view.options, progress));
    flown.identification.push_back(std::move(run));
  }
  return flown;
}

void take_output_error(CoefficientFit& fit, const ChosenOutputError& flown, const estimation::GroupScatter* scatter,
                       const FlightView& view) {
  if (!fit.chosen) return;
  fit.by_output_error = true;
  const AxisOutputError& run = run_of(flown.identification, fit.model.coefficient);
  const RegressionEstimate regression = *fit.chosen;
  std::optional<RegressionEstimate> part = part_of(run, fit);
  fit.comparison.reason = run.text;
  if (!part) {
    fit.chosen.reset();
    return;
  }
  fit.of_holdout = part_of(run_of(flown.holdout, fit.model.coefficient), fit);
  const bool scatters = scatter != nullptr && scatter->found();
  if (scatters) widen_to_scatter(*part, *scatter, view.options.significance);
  const bool converged = run.estimate.termination == estimation::OutputErrorTermination::kConverged;
  fit.comparison.recommends = converged;
  fit.comparison.checks = {agreement_with_regression(*part, regression)};
  for (std::size_t i = 0; i < fit.model.size(); ++i) fit.model.values[i] = part->theta(i);
  fit.chosen = std::move(part);
  if (!scatters) fit.unmodelled_share = unmodelled_share_of(fit);
}

Eigen::VectorXd widening_of(const CoefficientFit& fit, const ChosenOutputError& flown) {
  const AxisOutputError& run = run_of(flown.identification, fit.model.coefficient);
  const std::vector<Eigen::Index> at = places_of(fit.model, run);
  Eigen::VectorXd factors = Eigen::VectorXd::Zero(fit.model.size());
  for (std::size_t j = 0; j < at.size(); ++j) {
    const double before = run.estimate.covariance(at[j], at[j]);
    const double after = fit.chosen->covariance(j, j);
    if (std::isfinite(before) && before > 0.0 && std::isfinite(after)) factors(j) = std::sqrt(after / before);
  }
  return factors;
}

}  // namespace veridyn::aircraft::internal
