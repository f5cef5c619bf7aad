#pragma once

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/reconstruction/air_data_likelihood.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_run.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"
#include "veridyn/estimation/kalman/smoother.hpp"

/// Inside of reconstruct_solve: the passes of one kind of filter.
namespace veridyn::aircraft::internal {

[[nodiscard]] std::array<bool, kColumns.size()> wanted_columns(const ReconstructOptions& options, bool aerodynamics);

template <class Model>
[[nodiscard]] Model make_model(const SolveTask& task) {
  Model model;
  model.spectrum = task.spectrum;
  model.noise = noise_of(*task.streams, *task.options);
  if constexpr (Model::kHasAerodynamics) {
    model.subject = task.subject;
    model.error = model_error_of(*task.subject, *task.options);
  }
  return model;
}

/// Index of the state in the error vector for every column of a sensor error; -1 where the model has none.
template <class Model>
[[nodiscard]] int state_of_column(std::size_t column) {
  const int c = static_cast<int>(column);
  const int bias = static_cast<int>(kFirstImuBias), scale = static_cast<int>(kFirstImuScale),
            air = static_cast<int>(kFirstAirDataError), model = static_cast<int>(kFirstCoefficientError);
  if (c >= bias && c < scale && Model::kHasImuBiases) return Model::kImuBias + c - bias;
  if (c >= scale && c < air && Model::kHasImuScales) return Model::kImuScale + c - scale;
  if (c >= air && c < model && Model::kHasAirDataErrors) return Model::kAirDataError + c - air;
  if constexpr (Model::kHasAerodynamics) {
    if (c >= model) return Model::kCoefficientError + c - model;
  }
  return -1;
}

/// One pass of filter and smoother over all segments.
template <class Model>
void run_passes(const SolveTask& task, const RunSetting<Model>& setting, ResultColumns& smoothed_columns,
                ResultColumns* filtered_columns, Solution& solution, Progress& progress, double from, double to) {
  const FlightStreams& s = *task.streams;
  const std::vector<double>& stamps = *task.stamps;
  constexpr std::size_t kBlock = 512;
  constexpr std::size_t kReport = 4096;
  const double total = static_cast<double>(2 * stamps.size());
  std::size_t done = 0;
  bool going = true;
  std::size_t cursor = 0;
  double longest = 0.0;
  const auto report = [&] {
    return ++done % kReport != 0 || progress.update(from + (to - from) * static_cast<double>(done) / total);
  };
  solution.count = 0;
  for (std::size_t i = 0; i < task.segments.size() && going; ++i) {
    const Segment& segment = task.segments[i];
    const auto forward = [&](const FlightRun<Model>& now) {
      if (!now.at_output()) return true;
      if (filtered_columns) {
        filtered_columns->write(now.output(), setting.model, now.filter().state(), now.filter().covariance(),
                                s.density_at(now.time(), cursor));
      }
      solution.count = now.output() + 1;
      going = report();
      return going;
    };
    const auto smoothed = [&](std::size_t number, const typename Model::template State<double>& x,
                              const typename Model::Covariance& P) {
      smoothed_columns.write(number, setting.model, x, P, s.density_at(stamps[number], cursor));
      // Work that is stopped here ends what it has begun: it is a matter of seconds.
      static_cast<void>(report());
    };
    FlightRun<Model> run(setting, segment, start_of(setting, segment), solution.monitors, task.first_stamp[i]);
    const FlightRun<Model> end = estimation::smooth_in_blocks<Model>(run, kBlock, forward, smoothed);
    solution.monitors = end.monitors();
    if (segment.end - segment.begin <= longest) continue;
    longest = segment.end - segment.begin;
    for (std::size_t a = 0; a < solution.error_columns.size(); ++a) {
      for (std::size_t b = 0; b < solution.error_columns.size(); ++b) {
        const int row = state_of_column<Model>(solution.error_columns[a]);
        const int column = state_of_column<Model>(solution.error_columns[b]);
        solution.error_covariance(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) =
            row >= 0 && column >= 0 ? end.filter().covariance()(row, column) : 0.0;
      }
    }
  }
}

template <class Model>
[[nodiscard]] Solution solve(const SolveTask& task, Progress& progress) {
  static_assert(!Model::kHasAirDataErrors, "errors of the air data are estimated by likelihood, outside of the filter");
  const ReconstructOptions& o = *task.options;
  const std::size_t size = task.stamps->size();
  RunSetting<Model> setting{
      .streams = task.streams, .options = &o, .model = make_model<Model>(task), .output_t = task.stamps};
  const auto wanted = wanted_columns(o, Model::kHasAerodynamics);
  Solution solution;
  solution.smoothed.emplace(size, wanted);
  if (o.keep_filter) solution.filtered.emplace(size, wanted);
  for (std::size_t c = kFirstImuBias; c < kColumns.size(); ++c) {
    if (wanted[c]) solution.error_columns.push_back(c);
  }
  const auto n = static_cast<Eigen::Index>(solution.error_columns.size());
  solution.error_covariance = Eigen::MatrixXd::Zero(n, n);
  solution.monitors = monitors_with(o.gate);
  ResultColumns* filtered = solution.filtered ? &*solution.filtered : nullptr;
  if (!o.wants_air_data_errors()) {
    run_passes<Model>(task, setting, *solution.smoothed, filtered, solution, progress, 0.0, 1.0);
    return solution;
  }

  const AirDataErrors errors = estimate_air_data_errors(setting, task);
  solution.air_data_errors_converged = errors.converged;
  setting.air_error = solution.air_error = errors.value;
  setting.model.spectrum = errors.spectrum;
  const double parts = static_cast<double>(errors.index.size()) + 1.0;
  run_passes<Model>(task, setting, *solution.smoothed, filtered, solution, progress, 0.0, 1.0 / parts);
  const std::size_t count = solution.count;
  // What the errors leave uncertain in everything else: the estimate's derivative by each, by a shift of one sigma.
  const auto m = static_cast<Eigen::Index>(errors.index.size());
  const Eigen::VectorXd sigma = errors.covariance.diagonal().cwiseSqrt();
  const Eigen::MatrixXd correlation =
      sigma.cwiseInverse().asDiagonal() * errors.covariance * sigma.cwiseInverse().asDiagonal();
  std::vector<ResultColumns> smoothed_shifts, filtered_shifts;
  for (Eigen::Index i = 0; i < m; ++i) {
    setting.air_error = errors.value;
    setting.air_error(errors.index[static_cast<std::size_t>(i)]) += sigma(i);
    smoothed_shifts.emplace_back(size, wanted);
    if (filtered) filtered_shifts.emplace_back(size, wanted);
    Solution shifted;
    shifted.monitors = monitors_with(o.gate);
    run_passes<Model>(task, setting, smoothed_shifts.back(), filtered ? &filtered_shifts.back() : nullptr, shifted,
                      progress, static_cast<double>(i + 1) / parts, static_cast<double>(i + 2) / parts);
    solution.count = std::min(count, shifted.count);
  }
  solution.smoothed->widen(solution.count, smoothed_shifts, correlation);
  if (filtered) filtered->widen(solution.count, filtered_shifts, correlation);
  for (Eigen::Index i = 0; i < m; ++i) {
    const std::size_t column = kFirstAirDataError + static_cast<std::size_t>(errors.index[static_cast<std::size_t>(i)]);
    solution.smoothed->fill(column, errors.value(errors.index[static_cast<std::size_t>(i)]), sigma(i));
    if (filtered) filtered->fill(column, errors.value(errors.index[static_cast<std::size_t>(i)]), sigma(i));
    for (Eigen::Index j = 0; j < m; ++j) {
      const auto at = [&](Eigen::Index k) {
        const std::size_t c = kFirstAirDataError + static_cast<std::size_t>(errors.index[static_cast<std::size_t>(k)]);
        return std::find(solution.error_columns.begin(), solution.error_columns.end(), c) -
               solution.error_columns.begin();
      };
      solution.error_covariance(at(i), at(j)) = errors.covariance(i, j);
    }
  }
  return solution;
}

}  // namespace veridyn::aircraft::internal
