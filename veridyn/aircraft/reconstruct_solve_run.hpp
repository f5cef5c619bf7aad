#pragma once

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/reconstruct_run.hpp"
#include "veridyn/aircraft/reconstruct_solve.hpp"
#include "veridyn/estimation/smoother.hpp"

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

template <class Model>
[[nodiscard]] Solution solve(const SolveTask& task, Progress& progress) {
  using State = typename Model::template State<double>;
  const FlightStreams& s = *task.streams;
  const ReconstructOptions& o = *task.options;
  const std::vector<double>& stamps = *task.stamps;
  RunSetting<Model> setting{&s, &o, make_model<Model>(task), &stamps};
  const auto wanted = wanted_columns(o, Model::kHasAerodynamics);
  Solution solution;
  solution.smoothed.emplace(stamps.size(), wanted);
  solution.monitors = monitors_with(o.gate);
  if (o.keep_filter) solution.filtered.emplace(stamps.size(), wanted);
  for (std::size_t c = kFirstImuBias; c < kColumns.size(); ++c) {
    if (wanted[c]) solution.error_columns.push_back(c);
  }

  constexpr std::size_t kBlock = 512;
  constexpr std::size_t kReport = 4096;
  const int passes = o.passes();
  const double total = static_cast<double>(2 * stamps.size()) * (1.0 + passes);
  std::size_t done = 0;
  bool going = true;
  std::size_t cursor = 0;
  double longest = 0.0;
  const auto report = [&] {
    return ++done % kReport != 0 || progress.update(std::min(1.0, static_cast<double>(done) / total));
  };
  for (std::size_t i = 0; i < task.segments.size() && going; ++i) {
    const Segment& segment = task.segments[i];
    std::vector<State> nominal, smoothed_states;
    std::size_t events = 0;
    for (int pass = 0; pass <= passes; ++pass) {
      const bool last = pass == passes;
      setting.nominal = pass > 0 ? &nominal : nullptr;
      setting.mark_events = !last;
      smoothed_states.clear();
      const auto forward = [&](const FlightRun<Model>& now) {
        if (pass > 0) {
          if (now.at_output()) static_cast<void>(report());
          return now.events() < events;
        }
        events = now.events();
        if (!now.at_output()) return true;
        if (solution.filtered) {
          solution.filtered->write(now.output(), setting.model, now.filter().state(), now.filter().covariance(),
                                   s.density_at(now.time(), cursor));
        }
        solution.count = now.output() + 1;
        going = report();
        return going;
      };
      const auto smoothed = [&](std::size_t number, const State& x, const typename Model::Covariance& P) {
        if (!last) {
          if (number >= smoothed_states.size()) smoothed_states.resize(number + 1);
          smoothed_states[number] = x;
          return;
        }
        solution.smoothed->write(number, setting.model, x, P, s.density_at(stamps[number], cursor));
        // Work that is stopped here ends what it has begun: it is a matter of seconds.
        static_cast<void>(report());
      };
      FlightRun<Model> run(setting, segment, start_of(setting, segment), solution.monitors, task.first_stamp[i]);
      const FlightRun<Model> end = estimation::smooth_in_blocks<Model>(run, kBlock, forward, smoothed);
      if (pass == 0) solution.monitors = end.monitors();
      if (last && segment.end - segment.begin > longest) {
        longest = segment.end - segment.begin;
        const auto n = static_cast<Eigen::Index>(solution.error_columns.size());
        solution.error_covariance = Eigen::MatrixXd::Zero(n, n);
        for (Eigen::Index a = 0; a < n; ++a) {
          for (Eigen::Index b = 0; b < n; ++b) {
            const int row = state_of_column<Model>(solution.error_columns[static_cast<std::size_t>(a)]);
            const int column = state_of_column<Model>(solution.error_columns[static_cast<std::size_t>(b)]);
            if (row >= 0 && column >= 0) solution.error_covariance(a, b) = end.filter().covariance()(row, column);
          }
        }
      }
      nominal.swap(smoothed_states);
    }
  }
  return solution;
}

}  // namespace veridyn::aircraft::internal
