#include <algorithm>
#include <memory>

#include "veridyn/aircraft/reconstruction/guarded_filter.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_solve_run.hpp"

namespace veridyn::aircraft::internal {
namespace {

/// Goes through the recording with the guarded filter and writes its estimate.
template <class Free, class Based>
GuardTrace replay(const SolveTask& task, const Eigen::Matrix<double, 5, 1>& air_error, ResultColumns* filtered,
                  Progress& progress) {
  const FlightStreams& s = *task.streams;
  const ReconstructOptions& o = *task.options;
  const std::vector<double>& stamps = *task.stamps;
  GuardTrace trace;
  trace.model_based.assign(stamps.size(), 0);
  trace.nis_ratio.assign(stamps.size(), 0.0);
  const auto subject = std::make_shared<const Subject>(*task.subject);
  RunSetting<Free> setting{.streams = &s, .options = &o, .model = make_model<Free>(task), .output_t = &stamps};
  setting.air_error = air_error;
  constexpr std::size_t kReport = 4096;
  std::size_t done = 0, density = 0;
  for (std::size_t i = 0; i < task.segments.size(); ++i) {
    const Segment& segment = task.segments[i];
    const Start<Free> start = start_of(setting, segment);
    EventCursor cursor(s, stamps, segment, task.first_stamp[i]);
    GuardedFilter<Free, Based> filter(setting.model, make_model<Based>(task), subject, start.x, start.P, segment.begin,
                                      o.guard, o.gate);
    for (double time = cursor.next_time(); std::isfinite(time); time = cursor.next_time()) {
      const double dt = time - cursor.time();
      if (dt > 0.0) {
        typename Based::Input u;
        cursor.fill(u, time);
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
      if (filtered) {
        const double rho = s.density_at(time, density);
        if (filter.model_based()) {
          filtered->write(k, filter.based_model(), filter.based_filter().state(), filter.based_filter().covariance(),
                          rho);
        } else {
          filtered->write(k, filter.free_model(), filter.free_filter().state(), filter.free_filter().covariance(), rho);
        }
      }
      if (++done % kReport == 0 && !progress.update(static_cast<double>(done) / static_cast<double>(stamps.size())))
        return trace;
    }
    trace.falls += filter.guard().falls();
  }
  return trace;
}

}  // namespace

Solution solve_guarded(const SolveTask& task, Progress& progress) {
  Solution based = solve_model_based(task, progress);
  Solution free = solve_model_free(task, progress);
  ResultColumns* filtered = based.filtered ? &*based.filtered : nullptr;
  GuardTrace trace =
      task.options->wants_imu_biases()
          ? replay<AirDataModel<12, false>, ModelBasedAirData<12, false>>(task, free.air_error, filtered, progress)
          : replay<AirDataModel<0, false>, ModelBasedAirData<0, false>>(task, free.air_error, filtered, progress);
  based.count = std::min(based.count, free.count);

  // The model-based smoother is contaminated on both sides of a stretch in which the model was wrong.
  const std::vector<double>& stamps = *task.stamps;
  double last_wrong = -1e300;
  std::vector<char> believed = trace.model_based;
  for (std::size_t k = 0; k < believed.size(); ++k) {
    if (!trace.model_based[k]) last_wrong = stamps[k];
    if (stamps[k] - last_wrong < kGuardMargin_s) believed[k] = 0;
  }
  double next_wrong = 1e300;
  for (std::size_t k = believed.size(); k-- > 0;) {
    if (!trace.model_based[k]) next_wrong = stamps[k];
    if (next_wrong - stamps[k] < kGuardMargin_s) believed[k] = 0;
  }
  // Sensor errors are one statement about the flight: once the model was not believed, it has no say in them.
  for (std::size_t k = 0; k < based.count; ++k) {
    if (!believed[k]) based.smoothed->copy_sample(k, *free.smoothed);
    if (trace.falls > 0) based.smoothed->copy_errors(k, *free.smoothed);
  }
  if (trace.falls > 0) {
    based.monitors = free.monitors;
    based.error_columns = free.error_columns;
    based.error_covariance = free.error_covariance;
  }
  based.guard = std::move(trace);
  return based;
}

}  // namespace veridyn::aircraft::internal
