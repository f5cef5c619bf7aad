#include "veridyn/estimation/open_loop/open_loop_forecast.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/open_loop/open_loop_response.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;

/// The band is left where over so long [s] ...
constexpr double kLeft_s = 0.5;
/// ... the error is larger than so many sigma (RMS): noise that is white over that time does not get there, and what
/// all of its samples share once in 370 times.
constexpr double kLeft_sigma = kBeyondChance;

/// The sample at which the band is left, looking `ahead` samples on; the number of all where that never happens.
Index samples_inside(const Eigen::VectorXd& error, const Eigen::VectorXd& sigma, Index from, Index ahead) {
  // What was not measured leaves nothing.
  const Eigen::VectorXd squares =
      error.cwiseQuotient(sigma).cwiseAbs2().unaryExpr([](double s) { return std::isnan(s) ? 0.0 : s; });
  const double limit = kLeft_sigma * kLeft_sigma * static_cast<double>(ahead);
  for (Index k = from; k + ahead <= squares.size(); ++k)
    if (squares.segment(k, ahead).sum() > limit) return k;
  return squares.size();
}

/// Standard deviations of measured less predicted.
RowMatrix sigmas(const OpenLoopResponse& response, std::span<const RowMatrix> draws, const OpenLoopStart& start,
                 const OpenLoopProblem& problem) {
  const Index states = response.states.cols();
  RowMatrix sigma(response.states.rows(), states);
  for (Index k = 0; k < sigma.rows(); ++k) {
    const Eigen::MatrixXd S = response.conditions.middleRows(k * states, states);
    const Eigen::MatrixXd g = response.parameters.middleRows(k * states, states) + S * start.with_parameters;
    for (Index j = 0; j < states; ++j) {
      const double parameters = g.row(j).dot(problem.covariance * g.row(j).transpose());
      const double beginning = S.row(j).dot(start.covariance * S.row(j).transpose());
      const double white = problem.errors[j].white, lasting = problem.errors[j].lasting;
      sigma(k, j) = std::max(0.0, parameters) + std::max(0.0, beginning) + white * white + lasting * lasting;
    }
  }
  const auto drawn = [&](std::size_t d) {
    return draws[d].rows() > 0 && start.with_draws.col(signed_index(d)).allFinite();
  };
  double count = 0.0;
  for (std::size_t d = 0; d < draws.size(); ++d) count += drawn(d) ? 1.0 : 0.0;
  for (std::size_t d = 0; d < draws.size(); ++d) {
    if (!drawn(d)) continue;
    const Eigen::VectorXd made_up = response.conditions * start.with_draws.col(signed_index(d));
    for (Index k = 0; k < sigma.rows(); ++k)
      for (Index j = 0; j < states; ++j) sigma(k, j) += std::pow(draws[d](k, j) + made_up(k * states + j), 2.0) / count;
  }
  return sigma.cwiseSqrt();
}

OpenLoopForecast forecast(OpenLoopModel& model, std::size_t segment, const OpenLoopStart& start,
                          const RowMatrix& measured, const OpenLoopProblem& problem) {
  const auto states = signed_index(problem.errors.size());
  const double interval = model.sample_interval_s();
  OpenLoopForecast out;
  out.shift_s = problem.shift_s;
  OpenLoopWindow& window = out.window;
  window.recording = problem.recording;
  window.group = problem.group;
  window.span = model.segment_span(segment);
  window.forecast_from = std::min(window.span.end, window.span.begin + problem.start_s);
  const Index integrated = model.samples_before_divergence(segment, start.theta);
  window.diverged = integrated < model.samples(segment);
  model.shorten(segment, std::max<Index>(1, integrated));
  std::size_t i = model.parameters().size();
  for (const ModelParameter& p : model.initial_conditions(segment))
    window.start.push_back({segment, p.name, p.unit, start.theta(i++)});
  const OpenLoopResponse response = open_loop_response(model, segment, start.theta, problem.covariance);
  const Index n = response.states.rows();
  out.measured = measured.topLeftCorner(n, states);
  out.predicted = response.states;
  out.sigma = sigmas(response, model.disturbances(segment, start.theta), start, problem);
  for (Index k = 0; k < n; ++k) out.time.push_back(window.span.begin + interval * static_cast<double>(k));
  window.first_left_s = kInfinity;
  const auto from = static_cast<Index>(std::round(problem.start_s / interval));
  const auto ahead = std::max<Index>(1, static_cast<Index>(std::round(kLeft_s / interval)));
  for (Index j = 0; j < states; ++j) {
    const Index inside = samples_inside(out.predicted.col(j) - out.measured.col(j), out.sigma.col(j), from, ahead);
    window.horizon_s.push_back(interval * static_cast<double>(std::max<Index>(0, std::min(inside, n - 1) - from)));
    if (problem.judged[j]) window.first_left_s = std::min(window.first_left_s, window.horizon_s.back());
  }
  return out;
}

}  // namespace

std::vector<OpenLoopForecast> open_loop_forecasts(OpenLoopModel& model, OpenLoopModel& first,
                                                  const OpenLoopProblem& problem, Progress& progress) {
  if (model.segments() == 0) return {};
  const std::vector<RowMatrix> measured = model.measured();
  const std::vector<OpenLoopStart> starts = open_loop_starts(first, problem, progress);
  std::vector<OpenLoopForecast> forecasts(model.segments());
  for_each_segment(model, progress.threads(),
                   [&](std::size_t s) { forecasts[s] = forecast(model, s, starts[s], measured[s], problem); });
  std::erase_if(forecasts, [](const OpenLoopForecast& f) {
    return f.window.span.end - f.window.forecast_from < kLeastForecast_s && !f.window.diverged;
  });
  return forecasts;
}

}  // namespace veridyn::estimation
