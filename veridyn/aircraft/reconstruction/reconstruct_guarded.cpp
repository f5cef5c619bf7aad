#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include "veridyn/aircraft/reconstruction/guarded_filter.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft::internal {
namespace {

/// Where the model-based smoother's estimate stands: it is contaminated on both sides of a stretch in which the model
/// was wrong.
std::vector<char> trusted_samples(const GuardTrace& trace, std::span<const double> stamps) {
  std::vector<char> trusted = trace.model_based;
  double last_wrong = -kInfinity;
  for (std::size_t k = 0; k < trusted.size(); ++k) {
    if (!trace.model_based[k]) last_wrong = stamps[k];
    if (stamps[k] - last_wrong < kGuardMargin_s) trusted[k] = 0;
  }
  double next_wrong = kInfinity;
  for (std::size_t k = trusted.size(); k-- > 0;) {
    if (!trace.model_based[k]) next_wrong = stamps[k];
    if (next_wrong - stamps[k] < kGuardMargin_s) trusted[k] = 0;
  }
  return trusted;
}

/// What a guarded filter estimates along a recording: all but errors of the air data, which are known along a run.
std::optional<ColumnSet> columns_of_guarded(const ReconstructOptions& options, const FlightStreams& streams) {
  if (!options.keep_filter) return std::nullopt;
  ColumnSet columns = estimated_columns(options, streams, true);
  std::fill(columns.begin() + kFirstAirDataError, columns.begin() + kFirstCoefficientError, false);
  return columns;
}

/// The estimate of the filter that was active. What that does not estimate is the model-based filter's: errors of the
/// air data, and of the coefficients while the model-free filter was active.
ResultColumns with_active_filter(ResultColumns based, const GuardedPass& guarded) {
  for (std::size_t k = 0; k < guarded.count; ++k)
    based.copy_sample(k, *guarded.filtered, guarded.trace.model_based[k] ? kColumns.size() : kFirstCoefficientError);
  return based;
}

/// The model-based smoother's first `count` samples where they are trusted, else the model-free one's; of that all
/// errors of sensors where `free_errors`.
ResultColumns joined(ResultColumns based, const ResultColumns& free, const std::vector<char>& trusted,
                     std::size_t count, bool free_errors) {
  for (std::size_t k = 0; k < count; ++k) {
    if (!trusted[k]) based.copy_sample(k, free);
    if (free_errors) based.copy_columns(k, free, kFirstImuBias, kColumns.size());
  }
  return based;
}

}  // namespace

GuardedPass run_guarded(const SolveTask& task, const Eigen::Matrix<double, 5, 1>& air_error,
                        std::span<const ModelInUse> models, const std::optional<ColumnSet>& kept, Progress& progress) {
  const FlightStreams& s = *task.streams;
  const ReconstructOptions& o = *task.options;
  const std::vector<double>& stamps = *task.stamps;
  GuardedPass pass;
  if (kept) pass.filtered.emplace(stamps.size(), *kept);
  GuardTrace& trace = pass.trace;
  trace.model_based.assign(stamps.size(), 0);
  trace.nis_ratio.assign(stamps.size(), 0.0);
  RunSetting setting{.streams = &s, .options = &o, .motion = motion_of(task), .output_t = &stamps};
  setting.air_error = air_error;
  constexpr std::size_t kReport = 4096;
  std::size_t density = 0;
  for (std::size_t i = 0; i < task.segments.size(); ++i) {
    const Segment& segment = task.segments[i];
    EventCursor cursor(s, stamps, segment, task.first_stamp[i]);
    auto model = std::upper_bound(models.begin(), models.end(), segment.begin,
                                  [](double t, const ModelInUse& m) { return t < m.from_s; });
    const bool begun = model != models.begin();
    if (begun) setting.motion.error = std::prev(model)->error;
    GuardedFilter filter(o.estimates_imu_biases(), setting.motion, begun ? std::prev(model)->subject : nullptr,
                         start_of(setting, segment), segment.begin, o.guard, o.gate);
    for (double time = cursor.next_time(); std::isfinite(time); time = cursor.next_time()) {
      for (; model != models.end() && model->from_s <= cursor.time(); ++model)
        filter.set_model(model->subject, model->error);
      const double dt = time - cursor.time();
      if (dt > 0.0) {
        AirDataInput u;
        cursor.fill(u, time, true);
        filter.propagate(u, dt);
      }
      MeasurementContext context;
      bool known = false;
      cursor.step_to(time, [&](Sensor which, double z, double sigma) {
        if (!known) context = cursor.context(o, true);
        known = true;
        filter.measure(context, which, z, sigma);
      });
      filter.judge();
      if (!cursor.at_output()) continue;
      const std::size_t k = cursor.output();
      trace.model_based[k] = filter.model_based() ? 1 : 0;
      trace.nis_ratio[k] = filter.guard().worst();
      if (pass.filtered) {
        const AirDataEstimator& active = filter.active();
        pass.filtered->write(k, active.motion(), active.state(), active.covariance(), s.density_at(time, density));
      }
      pass.count = k + 1;
      if (pass.count % kReport == 0 &&
          !progress.update(static_cast<double>(pass.count) / static_cast<double>(stamps.size())))
        return pass;
    }
    trace.reverts += filter.guard().reverts();
  }
  return pass;
}

void add_guard_channels(const GuardTrace& trace, const TimeBase& time, std::size_t count, Recording& filtered) {
  const std::vector<double> used(trace.model_based.begin(), trace.model_based.begin() + count);
  filtered.add(make_channel("model_based", "1", time, used));
  filtered.add(make_channel("guard_ratio", "1", time,
                            {trace.nis_ratio.begin(), trace.nis_ratio.begin() + static_cast<std::ptrdiff_t>(count)}));
}

Solution solve_guarded(const SolveTask& task, Progress& progress) {
  // A wrong model, too, has the model-based filter refuse sensors: only the other tells a contradiction among them.
  Solution free = solve_model_free(task, progress);
  if (free.contradiction) return free;
  SolveTask whole = task;
  whole.ends_at_contradiction = false;
  Solution based = solve_model_based(whole, progress);
  const ModelInUse known{
      .from_s = -kInfinity, .subject = std::make_shared<const Subject>(*task.subject), .error = motion_of(task).error};
  GuardedPass guarded =
      run_guarded(task, free.air_error, {&known, 1}, columns_of_guarded(*task.options, *task.streams), progress);

  const bool reverted = guarded.trace.reverts > 0;
  const std::size_t count = std::min(based.count, free.count);
  const std::vector<char> trusted = trusted_samples(guarded.trace, *task.stamps);
  std::optional<ResultColumns> filtered;
  if (guarded.filtered) filtered = with_active_filter(*std::move(based.filtered), guarded);
  // Sensor errors are one estimate over the whole flight: once the model was not trusted, they come without it.
  Solution& errors = reverted ? free : based;
  return {.smoothed = joined(*std::move(based.smoothed), *free.smoothed, trusted, count, reverted),
          .filtered = std::move(filtered),
          .monitors = errors.monitors,
          .innovations = std::move(errors.innovations),
          .count = count,
          .error_columns = std::move(errors.error_columns),
          .error_covariance = std::move(errors.error_covariance),
          .air_error = based.air_error,
          .air_error_found = errors.air_error_found,
          .air_data_errors_converged = based.air_data_errors_converged,
          .not_applied = std::move(errors.not_applied),
          .guard = std::move(guarded.trace),
          .contradiction = based.contradiction};
}

}  // namespace veridyn::aircraft::internal
