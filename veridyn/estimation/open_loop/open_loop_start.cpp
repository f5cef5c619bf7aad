#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/open_loop/open_loop_forecast.hpp"
#include "veridyn/estimation/open_loop/open_loop_response.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;

/// The parameters and the initial conditions at which a segment starts, before these are estimated.
Eigen::VectorXd unfitted(const OpenLoopModel& model, std::size_t segment) {
  std::vector<double> theta;
  for (const ModelParameter& p : model.parameters()) theta.push_back(p.start);
  for (const ModelParameter& p : model.initial_conditions(segment)) theta.push_back(p.start);
  return Eigen::Map<const Eigen::VectorXd>(theta.data(), signed_index(theta.size()));
}

/// The covariance of what was fitted to `rows`, and how it follows the parameters.
void add_covariance(const OpenLoopModel& model, std::size_t segment, const Eigen::VectorXd& weights,
                    std::span<const Index> rows, const OpenLoopProblem& problem, OpenLoopStart& start) {
  const auto states = signed_index(model.forecast_outputs());
  const auto shared = signed_index(model.parameters().size()), own = start.theta.size() - shared;
  const std::span<const ModelParameter> conditions = model.initial_conditions(segment);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(own, own), cross = Eigen::MatrixXd::Zero(own, shared);
  for (Index i = 0; i < own; ++i) information(i, i) = std::pow(conditions[i].prior_sigma, -2.0);
  const OpenLoopResponse r = open_loop_response(model, segment, start.theta, problem.covariance);
  if (r.states.rows() > 0) {
    for (const Index k : rows) {
      const auto A = r.conditions.middleRows(k * states, states), B = r.parameters.middleRows(k * states, states);
      information += A.transpose() * weights.asDiagonal() * A;
      cross += A.transpose() * weights.asDiagonal() * B;
    }
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(information);
  const std::vector<RowMatrix> draws = model.disturbances(segment, start.theta);
  start.with_draws = Eigen::MatrixXd::Constant(own, signed_index(draws.size()), kNaN);
  for (std::size_t d = 0; d < draws.size(); ++d) {
    if (draws[d].rows() == 0 || r.states.rows() == 0) continue;
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(own);
    for (const Index k : rows)
      pull +=
          r.conditions.middleRows(k * states, states).transpose() * weights.cwiseProduct(draws[d].row(k).transpose());
    start.with_draws.col(signed_index(d)) = -solver.solve(pull);
  }
  start.covariance = solver.solve(Eigen::MatrixXd::Identity(own, own));
  start.with_parameters = -solver.solve(cross);
  for (Index i = 0; i < own; ++i)
    if (std::ranges::find(problem.drifting, conditions[i].name) != problem.drifting.end())
      start.covariance(i, i) += std::pow(conditions[i].prior_sigma, 2.0);
}

/// What the disturbances do to each output, as an error of independent rows: [SI]^2.
Eigen::VectorXd disturbed_variance(const OpenLoopModel& model, std::span<const OpenLoopStart> starts,
                                   const std::vector<std::vector<Index>>& rows) {
  const auto states = signed_index(model.forecast_outputs());
  // Of a sum over the rows, whose variance is what counts: rows in which one gust lasts are fewer than they look.
  Eigen::VectorXd of_sums = Eigen::VectorXd::Zero(states);
  double count = 0.0;
  for (std::size_t s = 0; s < model.segments(); ++s) {
    for (const RowMatrix& draw : model.disturbances(s, starts[s].theta)) {
      if (draw.rows() == 0) continue;
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(states);
      for (const Index k : rows[s]) sum += draw.row(k).transpose();
      of_sums += sum.cwiseAbs2();
      count += static_cast<double>(rows[s].size());
    }
  }
  return count > 0.0 ? Eigen::VectorXd(of_sums / count) : of_sums;
}

}  // namespace

std::vector<OpenLoopStart> open_loop_starts(OpenLoopModel& first, const OpenLoopProblem& problem, Progress& progress) {
  const auto states = signed_index(first.forecast_outputs());
  const auto stride = signed_index(problem.stride);
  std::vector<RowMatrix> measured = first.measured();
  std::vector<std::vector<Index>> rows(first.segments());
  std::vector<OpenLoopStart> starts;
  std::size_t most = 0;
  for (std::size_t s = 0; s < first.segments(); ++s) {
    starts.push_back({.theta = unfitted(first, s), .covariance = {}, .with_parameters = {}, .with_draws = {}});
    const auto wanted = static_cast<Index>(std::round(problem.start_s / first.sample_interval_s())) + 1;
    first.shorten(s, std::min(wanted, first.samples(s)));
    first.shorten(s, std::max<Index>(1, first.samples_before_divergence(s, starts[s].theta)));
    // Samples within the filters' memory of each other tell the same.
    for (Index k = 0; k < first.samples(s); k += stride) rows[s].push_back(k);
    RowMatrix thinned = RowMatrix::Constant(first.samples(s), measured[s].cols(), kNaN);
    for (const Index k : rows[s]) thinned.row(k).head(states) = measured[s].row(k).head(states);
    measured[s] = std::move(thinned);
    most = std::max(most, rows[s].size());
  }
  OutputErrorOptions fit;
  fit.noise = OutputNoise::kGiven;
  fit.covariance = CovarianceKind::kWhite;
  fit.noise_start = Eigen::VectorXd::Ones(first.outputs().size());
  for (std::size_t j = 0; j < problem.errors.size(); ++j) {
    const OpenLoopError& error = problem.errors[j];
    const double alike =
        std::clamp(error.memory / static_cast<double>(problem.stride), 1.0, std::max(1.0, static_cast<double>(most)));
    fit.noise_start(j) = std::hypot(error.white, error.lasting * std::sqrt(alike));
  }
  const Eigen::VectorXd disturbed = disturbed_variance(first, starts, rows);
  for (Index j = 0; j < states; ++j)
    fit.noise_start(j) = std::sqrt(fit.noise_start(j) * fit.noise_start(j) + disturbed(j));
  const OutputErrorEstimate fitted = output_error(first, measured, fit, progress);
  if (fitted.has_estimate()) {
    std::vector<Index> place(first.segments(), first.parameters().size());
    for (const SegmentParameter& p : fitted.segment_parameters) starts[p.segment].theta(place[p.segment]++) = p.value;
  }
  const Eigen::VectorXd weights = fit.noise_start.head(states).cwiseAbs2().cwiseInverse();
  for (std::size_t s = 0; s < first.segments(); ++s) add_covariance(first, s, weights, rows[s], problem, starts[s]);
  return starts;
}

}  // namespace veridyn::estimation
