#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/reconstruction/air_data_likelihood.hpp"

namespace veridyn::aircraft::internal {
namespace {

std::array<bool, kColumns.size()> wanted_columns(const ReconstructOptions& o, bool aerodynamics) {
  std::array<bool, kColumns.size()> wanted{};
  std::fill_n(wanted.begin(), kFirstImuBias, true);
  for (std::size_t k = 0; k < 3; ++k) {
    wanted[kFirstImuBias + k] = o.gyro_bias;
    wanted[kFirstImuBias + 3 + k] = o.accel_bias;
    wanted[kFirstImuScale + k] = o.gyro_scale;
    wanted[kFirstImuScale + 3 + k] = o.accel_scale;
    wanted[kFirstCoefficientError + k] = aerodynamics;
  }
  const std::array<bool, 5> errors{o.alpha_bias, o.beta_bias, o.alpha_scale, o.pitot_scale, o.pitot_bias};
  std::copy(errors.begin(), errors.end(), wanted.begin() + kFirstAirDataError);
  return wanted;
}

/// Where the estimates of a pass go; `filtered` may be null.
struct PassColumns {
  ResultColumns* smoothed;
  ResultColumns* filtered;
};

/// The share of the progress that a pass makes up.
struct PassProgress {
  Progress* progress;
  double from, to;
};

/// One pass of filter and smoother over all segments.
void run_passes(const FilterEngine& engine, const SolveTask& task, const RunSetting& setting, PassColumns columns,
                Solution& solution, PassProgress share) {
  const FlightStreams& s = *task.streams;
  const std::vector<double>& stamps = *task.stamps;
  constexpr std::size_t kReport = 4096;
  const double total = static_cast<double>(2 * stamps.size());
  std::size_t done = 0;
  bool going = true;
  std::size_t cursor = 0;
  double longest = 0.0;
  const auto report = [&] {
    return ++done % kReport != 0 ||
           share.progress->update(share.from + (share.to - share.from) * static_cast<double>(done) / total);
  };
  solution.count = 0;
  const auto filtered = [&](std::size_t output, double time, const AirDataState<double>& x, const CovarianceView& P) {
    if (columns.filtered) columns.filtered->write(output, setting.motion, x, P, s.density_at(time, cursor));
    solution.count = output + 1;
    going = report();
    return going;
  };
  const auto smoothed = [&](std::size_t output, const AirDataState<double>& x, const CovarianceView& P) {
    columns.smoothed->write(output, setting.motion, x, P, s.density_at(stamps[output], cursor));
    // Work that is stopped here ends what it has begun: it is a matter of seconds.
    static_cast<void>(report());
  };
  for (std::size_t i = 0; i < task.segments.size() && going; ++i) {
    const Segment& segment = task.segments[i];
    PassEnd end = engine.smooth(setting, segment, solution.monitors, task.first_stamp[i], solution.error_columns,
                                filtered, smoothed);
    solution.monitors = end.monitors;
    if (segment.end - segment.begin <= longest) continue;
    longest = segment.end - segment.begin;
    solution.error_covariance = std::move(end.error_covariance);
  }
}

/// The same with errors of the air data: they are estimated first; what they leave uncertain in everything else comes
/// by passes with each moved by one sigma.
void solve_with_air_data_errors(const FilterEngine& engine, const SolveTask& task, RunSetting setting,
                                const std::array<bool, kColumns.size()>& wanted, Solution& solution,
                                Progress& progress) {
  const ReconstructOptions& o = *task.options;
  const std::size_t size = task.stamps->size();
  ResultColumns* const filtered = solution.filtered ? &*solution.filtered : nullptr;
  const AirDataErrors errors = estimate_air_data_errors(engine, setting, task);
  solution.air_data_errors_converged = errors.converged;
  setting.air_error = solution.air_error = errors.value;
  setting.motion.spectrum = errors.spectrum;
  const double parts = static_cast<double>(errors.index.size()) + 1.0;
  run_passes(engine, task, setting, {&*solution.smoothed, filtered}, solution, {&progress, 0.0, 1.0 / parts});
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
    run_passes(engine, task, setting, {&smoothed_shifts.back(), filtered ? &filtered_shifts.back() : nullptr}, shifted,
               {&progress, static_cast<double>(i + 1) / parts, static_cast<double>(i + 2) / parts});
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
}

}  // namespace

Monitors monitors_with(const estimation::InnovationGate& gate) {
  Monitors monitors;
  monitors.fill(estimation::InnovationMonitor(gate));
  return monitors;
}

AirDataNoise noise_of(const FlightStreams& s, const ReconstructOptions& o) {
  AirDataNoise noise;
  noise.gyro = s.sigma.gyro * std::sqrt(s.gyro.interval);
  noise.accelerometer = s.sigma.accelerometer * std::sqrt(s.accel.interval);
  noise.wind_walk = o.wind_walk;
  noise.wind_down_walk = o.wind_down_walk;
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
  const ReconstructOptions& o = *task.options;
  const std::size_t size = task.stamps->size();
  RunSetting setting{.streams = task.streams, .options = &o, .motion = motion_of(task), .output_t = task.stamps};
  const auto wanted = wanted_columns(o, engine.has_forces());
  Solution solution;
  solution.smoothed.emplace(size, wanted);
  if (o.keep_filter) solution.filtered.emplace(size, wanted);
  for (std::size_t c = kFirstImuBias; c < kColumns.size(); ++c) {
    if (wanted[c]) solution.error_columns.push_back(c);
  }
  const auto n = static_cast<Eigen::Index>(solution.error_columns.size());
  solution.error_covariance = Eigen::MatrixXd::Zero(n, n);
  solution.monitors = monitors_with(o.gate);
  ResultColumns* const filtered = solution.filtered ? &*solution.filtered : nullptr;
  if (o.wants_air_data_errors()) {
    solve_with_air_data_errors(engine, task, setting, wanted, solution, progress);
  } else {
    run_passes(engine, task, setting, {&*solution.smoothed, filtered}, solution, {&progress, 0.0, 1.0});
  }
  return solution;
}

Solution solve_model_free(const SolveTask& task, Progress& progress) {
  return solve(*model_free_engine(task.options->wants_imu_biases()), task, progress);
}

Solution solve_model_based(const SolveTask& task, Progress& progress) {
  return solve(*model_based_engine(task.options->wants_imu_biases()), task, progress);
}

std::array<double, 5> air_data_error_priors() {
  return {kVaneBiasPrior, kVaneBiasPrior, kAlphaScalePrior, kPitotScalePrior, kPitotBiasPrior};
}

std::vector<int> wanted_air_data_errors(const ReconstructOptions& o) {
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
