#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <thread>

#include "veridyn/aircraft/reconstruction/air_data_check.hpp"
#include "veridyn/aircraft/reconstruction/air_data_likelihood.hpp"
#include "veridyn/aircraft/reconstruction/contradiction.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::aircraft::internal {
namespace {

std::vector<std::size_t> error_columns_of(const ColumnSet& columns) {
  std::vector<std::size_t> errors;
  for (std::size_t c = kFirstImuBias; c < kColumns.size(); ++c) {
    if (columns[c]) errors.push_back(c);
  }
  return errors;
}

/// Short faults are no contradiction: what is refused must also be a twentieth of the recording.
estimation::InnovationGate gate_of(const SolveTask& task) {
  constexpr double kLeastShare = 0.05;
  estimation::InnovationGate gate = task.options->gate;
  double total_s = 0.0;
  for (const Segment& segment : task.segments) total_s += segment.end - segment.begin;
  gate.dead_reckoning_s =
      task.ends_at_contradiction ? std::max(gate.dead_reckoning_s, kLeastShare * total_s) : kInfinity;
  return gate;
}

/// View of a progress, of which a pass makes up the share `from` to `to`.
struct PassProgress {
  Progress* progress;
  double from, to;
};

/// One pass of filter and smoother over all segments.
Solution run_pass(const FilterEngine& engine, const SolveTask& task, const RunSetting& setting,
                  const ColumnSet& columns, PassProgress share) {
  const FlightStreams& s = *task.streams;
  const std::vector<double>& stamps = *task.stamps;
  Solution solution;
  solution.smoothed.emplace(stamps.size(), columns);
  if (task.options->keep_filter) solution.filtered.emplace(stamps.size(), columns);
  solution.error_columns = error_columns_of(columns);
  const auto n = static_cast<Eigen::Index>(solution.error_columns.size());
  solution.error_covariance = Eigen::MatrixXd::Zero(n, n);
  solution.monitors = monitors_with(gate_of(task));
  solution.air_error = setting.air_error;

  constexpr std::size_t kReport = 4096;
  const double total = static_cast<double>(2 * stamps.size());
  std::atomic<std::size_t> done = 0;
  std::size_t next_report = kReport;
  bool going = true;
  std::size_t cursor = 0;
  double longest = 0.0;
  const std::thread::id caller = std::this_thread::get_id();
  const auto report = [&] {
    const std::size_t now = ++done;
    if (std::this_thread::get_id() != caller || now < next_report) return true;
    next_report = now + kReport;
    return share.progress->update(share.from + (share.to - share.from) * static_cast<double>(now) / total);
  };
  const auto filtered = [&](std::size_t output, double time, const AirDataState<double>& x, const CovarianceView& P) {
    if (solution.filtered) solution.filtered->write(output, setting.motion, x, P, s.density_at(time, cursor));
    solution.count = output + 1;
    going = report();
    return going;
  };
  const auto smoothed = [&](std::size_t output, const AirDataState<double>& x, const CovarianceView& P) {
    solution.smoothed->write(output, setting.motion, x, P, s.density_at(stamps[output]));
    // Work that is stopped here ends what it has begun: it is a matter of seconds.
    static_cast<void>(report());
  };
  FilterEngine::OnInnovation seen;
  if (task.options->keep_innovations)
    seen = [&solution](double time, const SensorInnovation& now) {
      if (!now.offered) return;
      InnovationHistory& history = solution.innovations[now.sensor];
      history.time.push_back(time);
      history.innovation.push_back(now.nu);
      history.sigma.push_back(std::sqrt(now.S));
      history.refused.push_back(now.accepted ? 0.0 : 1.0);
    };
  for (std::size_t i = 0; i < task.segments.size() && going; ++i) {
    const Segment& segment = task.segments[i];
    PassEnd end = engine.smooth(setting, segment, solution.monitors, task.first_stamp[i], solution.error_columns,
                                share.progress->threads(), filtered, smoothed, seen);
    solution.monitors = end.monitors;
    solution.contradiction = contradiction_of(s, end.monitors);
    if (solution.contradiction) {
      const auto before = std::lower_bound(stamps.begin(), stamps.end(), solution.contradiction->span.begin);
      solution.count = std::min(solution.count, static_cast<std::size_t>(before - stamps.begin()));
      break;
    }
    if (segment.end - segment.begin <= longest) continue;
    longest = segment.end - segment.begin;
    solution.error_covariance = std::move(end.error_covariance);
  }
  return solution;
}

/// The same with errors of the air data: they are estimated first; what they leave uncertain in everything else comes
/// by passes with each moved by one sigma.
Solution solve_with_air_data_errors(const FilterEngine& engine, const SolveTask& task, RunSetting setting,
                                    const ColumnSet& columns, Progress& progress) {
  const AirDataErrors errors =
      engine.has_forces() ? estimate_air_data_errors(engine, setting, task) : check_air_data_errors(setting, task);
  setting.air_error = errors.correction();
  setting.motion.spectrum = errors.spectrum;
  const double parts = static_cast<double>(errors.applied.size()) + 1.0;
  Solution solution = run_pass(engine, task, setting, columns, {&progress, 0.0, 1.0 / parts});
  solution.air_data_errors_converged = errors.converged;
  if (solution.contradiction) return solution;
  const std::size_t count = solution.count;
  // What the errors leave uncertain in everything else: the estimate's derivative by each, by a shift of one sigma.
  const auto m = static_cast<Eigen::Index>(errors.index.size());
  const Eigen::VectorXd sigma = errors.covariance.diagonal().cwiseSqrt();
  const Eigen::MatrixXd correlation =
      sigma.cwiseInverse().asDiagonal() * errors.covariance * sigma.cwiseInverse().asDiagonal();
  std::vector<ResultColumns> smoothed_shifts, filtered_shifts;
  // Innovations are those of the first pass.
  ReconstructOptions of_shifts = *task.options;
  of_shifts.keep_innovations = false;
  SolveTask shift = task;
  shift.options = &of_shifts;
  for (std::size_t k = 0; k < errors.applied.size(); ++k) {
    const Eigen::Index i = errors.applied[k];
    setting.air_error = errors.correction();
    setting.air_error(errors.index[i]) += sigma(i);
    Solution shifted = run_pass(engine, shift, setting, columns,
                                {&progress, static_cast<double>(k + 1) / parts, static_cast<double>(k + 2) / parts});
    smoothed_shifts.push_back(std::move(*shifted.smoothed));
    if (shifted.filtered) filtered_shifts.push_back(std::move(*shifted.filtered));
    solution.count = std::min(count, shifted.count);
  }
  const Eigen::MatrixXd of_applied = correlation(errors.applied, errors.applied);
  setting.air_error = errors.correction();
  solution.air_error_found = errors.value;
  solution.smoothed->widen(solution.count, smoothed_shifts, of_applied);
  if (solution.filtered) solution.filtered->widen(solution.count, filtered_shifts, of_applied);
  for (Eigen::Index i = 0; i < m; ++i) {
    const auto index = errors.index[i];
    const std::size_t column = kFirstAirDataError + static_cast<std::size_t>(index);
    if (std::ranges::find(errors.applied, i) == errors.applied.end())
      solution.not_applied.emplace_back(kColumns[column].name);
    // What is taken off the readings, also by those who read the channel.
    solution.smoothed->fill(column, setting.air_error(index), sigma(i));
    if (solution.filtered) solution.filtered->fill(column, setting.air_error(index), sigma(i));
    for (Eigen::Index j = 0; j < m; ++j) {
      const auto at = [&](Eigen::Index k) {
        const std::size_t c = kFirstAirDataError + static_cast<std::size_t>(errors.index[k]);
        return std::find(solution.error_columns.begin(), solution.error_columns.end(), c) -
               solution.error_columns.begin();
      };
      solution.error_covariance(at(i), at(j)) = errors.covariance(i, j);
    }
  }
  return solution;
}

}  // namespace

ColumnSet estimated_columns(const ReconstructOptions& o, const FlightStreams& streams, bool aerodynamics) {
  ColumnSet columns{};
  std::fill_n(columns.begin(), kFirstImuBias, true);
  const auto leave_out = [&columns](std::initializer_list<const char*> names) {
    for (const char* name : names)
      columns[std::ranges::find(kColumns, std::string_view(name),
                                [](const ColumnName& c) { return std::string_view(c.name); }) -
              kColumns.begin()] = false;
  };
  // Nothing tells the motion over ground from that of the air.
  if (!streams.has_ground_velocity())
    leave_out({"wind_north", "wind_east", "wind_total_north", "wind_total_east", "vel_north", "vel_east"});
  if (!streams.has_ground_velocity() && !streams.has(kVelDown)) leave_out({"wind_down", "wind_total_down", "vel_down"});
  if (!streams.has_ground_velocity() && !streams.has(kYaw)) leave_out({"yaw"});
  for (std::size_t k = 0; k < 3; ++k) {
    columns[kFirstImuBias + k] = o.gyro_bias;
    columns[kFirstImuBias + 3 + k] = o.accel_bias;
    columns[kFirstImuScale + k] = o.gyro_scale;
    columns[kFirstImuScale + 3 + k] = o.accel_scale;
    columns[kFirstCoefficientError + k] = aerodynamics;
  }
  const std::array<bool, 5> errors{o.alpha_bias, o.beta_bias, o.alpha_scale, o.pitot_scale, o.pitot_bias};
  std::copy(errors.begin(), errors.end(), columns.begin() + kFirstAirDataError);
  return columns;
}

OutputStamps output_stamps(const FlightStreams& s, std::span<const Segment> segments, double rate_Hz) {
  OutputStamps stamps;
  for (const Segment& segment : segments) {
    stamps.first.push_back(stamps.time.size());
    if (rate_Hz > 0.0) {
      for (double k = std::ceil(segment.begin * rate_Hz); k / rate_Hz <= segment.end; ++k)
        stamps.time.push_back(k / rate_Hz);
      continue;
    }
    const auto first = std::lower_bound(s.gyro.t.begin(), s.gyro.t.end(), segment.begin);
    const auto last = std::upper_bound(first, s.gyro.t.end(), segment.end);
    stamps.time.insert(stamps.time.end(), first, last);
  }
  return stamps;
}

Monitors monitors_with(const estimation::InnovationGate& gate) {
  Monitors monitors;
  monitors.fill(estimation::InnovationMonitor(gate));
  return monitors;
}

AirDataNoise noise_of(const FlightStreams& s, const ReconstructOptions& o) {
  AirDataNoise noise;
  noise.gyro = s.sigma.gyro * std::sqrt(s.gyro.interval);
  noise.accelerometer = s.sigma.accelerometer * std::sqrt(s.accel.interval);
  // Without ground velocity the velocity is that through the slow wind, which has then no say.
  noise.wind_walk = s.has_ground_velocity() ? o.wind_walk : 0.0;
  noise.wind_down_walk = s.has_ground_velocity() || s.has(kVelDown) ? o.wind_down_walk : 0.0;
  return noise;
}

ModelError model_error_of(const Subject& subject, const ReconstructOptions& o) {
  ModelError error{.initial = o.model_error, .walk = o.model_error_walk, .modelled = {}};
  constexpr std::array<Coefficient, 3> kForces{Coefficient::kCL, Coefficient::kCD, Coefficient::kCY};
  for (std::size_t i = 0; i < 3; ++i) error.modelled[i] = subject.model.find(kForces[i]) != nullptr;
  return error;
}

ModelBasedMotion motion_of(const SolveTask& task) {
  ModelBasedMotion motion;
  motion.spectrum = task.spectrum;
  motion.noise = noise_of(*task.streams, *task.options);
  if (task.subject != nullptr) {
    motion.subject = task.subject;
    motion.error = model_error_of(*task.subject, *task.options);
  }
  return motion;
}

Solution solve(const FilterEngine& engine, const SolveTask& task, Progress& progress) {
  const RunSetting setting{
      .streams = task.streams, .options = task.options, .motion = motion_of(task), .output_t = task.stamps};
  const ColumnSet columns = estimated_columns(*task.options, *task.streams, engine.has_forces());
  if (task.options->estimates_air_data_errors())
    return solve_with_air_data_errors(engine, task, setting, columns, progress);
  return run_pass(engine, task, setting, columns, {&progress, 0.0, 1.0});
}

Solution solve_model_free(const SolveTask& task, Progress& progress) {
  return solve(*model_free_engine(task.options->estimates_imu_biases()), task, progress);
}

Solution solve_model_based(const SolveTask& task, Progress& progress) {
  return solve(*model_based_engine(task.options->estimates_imu_biases()), task, progress);
}

std::array<double, 5> air_data_error_priors() {
  return {kVaneBiasPrior, kVaneBiasPrior, kAlphaScalePrior, kPitotScalePrior, kPitotBiasPrior};
}

std::vector<int> estimated_air_data_errors(const ReconstructOptions& o) {
  using Model = AirDataErrorVector;
  std::vector<int> index;
  if (o.alpha_bias) index.push_back(Model::kAlphaBias);
  if (o.beta_bias) index.push_back(Model::kBetaBias);
  if (o.alpha_scale) index.push_back(Model::kAlphaScale);
  if (o.pitot_scale) index.push_back(Model::kPitotScale);
  if (o.pitot_bias) index.push_back(Model::kPitotBias);
  return index;
}

}  // namespace veridyn::aircraft::internal
