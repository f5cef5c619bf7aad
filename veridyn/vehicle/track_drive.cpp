#include "veridyn/vehicle/track_drive.hpp"

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/modulating_kernel.hpp"
#include "veridyn/recording/study_data.hpp"

namespace veridyn::vehicle {
namespace {

/// Noise of the sensors is learned from the beginning of a drive [s].
constexpr double kLearn_s = 20.0;
/// Read again before the first new sample, for the interpolation [s].
constexpr double kWarm_s = 2.0;

DriveSample sample_of(const DriveSignals& s, std::size_t k, const std::vector<double>& yaw_acceleration) {
  DriveSample out;
  out.time = s.grid.at(k);
  out.steer = s[DriveSignal::kSteer].value[k];
  out.speed = s[DriveSignal::kSpeed].value[k];
  out.yaw_rate = s[DriveSignal::kYawRate].value[k];
  const double r = out.yaw_rate;
  out.accel_y = s[DriveSignal::kAccelY].value[k] + s.accel_position[1] * r * r;
  if (s.accel_position[0] != 0.0) out.accel_y -= s.accel_position[0] * yaw_acceleration[k];
  return out;
}

void require_accel(const DriveSignals& signals) {
  if (signals[DriveSignal::kAccelY].available()) return;
  throw InputError(signals.source, "has no accel_y, which tracking needs");
}

}  // namespace

TrackedDrive::TrackedDrive(const VehicleStudy& study)
    : subject_(study.subject_name),
      start_(study.vehicle),
      options_(study.track),
      signals_(study.signals),
      min_speed_(study.segments.min_speed_mps) {
  if (!options_.estimate_file.empty()) begin_ = io::read_estimate(options_.estimate_file);
}

std::vector<DriveChange> TrackedDrive::advance(const recording::MappedRecording& mapped, bool finished,
                                               Progress& progress) {
  std::vector<DriveChange> found;
  const TimeSpan span = mapped.recording.span();
  if (!tracker_) {
    if (!finished && span.duration() < kLearn_s) return found;
    recording::MappedRecording first = mapped;
    first.recording = recording::cut(mapped.recording, {span.begin, span.begin + kLearn_s});
    const DriveSignals signals = prepare_drive_signals(first, signals_);
    require_accel(signals);
    notes_ = signals.notes;
    // The rate is kept, whatever later parts would suggest.
    signals_.rate_Hz = signals.grid.rate_Hz();
    const std::array<double, 4> noise{signals[DriveSignal::kSteer].sigma, signals[DriveSignal::kSpeed].sigma,
                                      signals[DriveSignal::kYawRate].sigma, signals[DriveSignal::kAccelY].sigma};
    tracker_.emplace(start_, options_, min_speed_, signals_.rate_Hz, noise, begin_ ? &*begin_ : nullptr);
  }
  const double last = tracker_->last_time();
  recording::MappedRecording part = mapped;
  if (std::isfinite(last)) {
    if (!(span.end > last + kWarm_s) && !finished) return found;
    part.recording = recording::cut(mapped.recording, {last - kWarm_s, kInfinity});
  }
  const DriveSignals signals = prepare_drive_signals(part, signals_);
  require_accel(signals);
  std::vector<double> yaw_acceleration;
  if (signals.accel_position[0] != 0.0) {
    const numerics::ModulatingKernel kernel =
        numerics::modulating_kernel(signals.grid.rate_Hz(), 0.1 * signals.grid.rate_Hz());
    yaw_acceleration = numerics::filter(signals[DriveSignal::kYawRate].value, kernel.first);
  }
  // What lies close to the end may still change when more is read.
  const double until = finished ? kInfinity : span.end - 0.5 * kWarm_s;
  for (std::size_t k = 0; k < signals.size(); ++k) {
    const double t = signals.grid.at(k);
    if (!(t > last + 0.5 * signals.grid.step) || t > until) continue;
    const std::vector<DriveChange> more = tracker_->append(sample_of(signals, k, yaw_acceleration));
    found.insert(found.end(), more.begin(), more.end());
    if (k % 10000 == 0 && !progress.update(static_cast<double>(k) / static_cast<double>(signals.size()))) break;
  }
  return found;
}

estimation::Estimate TrackedDrive::estimate() const {
  if (tracker_) {
    estimation::Estimate out = tracker_->estimate(subject_);
    out.warnings.insert(out.warnings.end(), notes_.begin(), notes_.end());
    return out;
  }
  estimation::Estimate out;
  out.subject = subject_;
  out.method = "on line";
  out.verdict = "nothing was followed yet";
  return out;
}

DriveTracking track(const VehicleStudy& study, Progress& progress) {
  progress.stage("tracking");
  DriveTracking out{TrackedDrive(study), false};
  static_cast<void>(out.drive.advance(study.log.mapped, true, progress));
  out.interrupted = progress.interrupted();
  return out;
}

Recording history_recording(const DriveTracker& tracker) {
  Recording out;
  out.source = "track.csv";
  out.frame = Frame::kFlu;
  for (const TrackedAxle axle : kAllTrackedAxles) {
    const DriveTrackHistory& h = tracker.history(axle);
    if (h.time.empty()) continue;
    const std::string name(kTrackedAxleNames[axle]), unit(kTrackedAxleUnits[axle]);
    const TimeBase time = make_time_base(h.time);
    const auto add = [&](std::string channel, const std::string& of, std::vector<double> values) {
      for (double& v : values) {
        if (std::isinf(v)) v = kNaN;
      }
      out.add(make_channel(std::move(channel), of, time, std::move(values)));
    };
    add(name, unit, h.value);
    add("sigma_" + name, unit, h.sigma);
    add("held_" + name, "1", {h.held.begin(), h.held.end()});
    add("suspicion_" + name, "1", h.suspicion);
  }
  return out;
}

}  // namespace veridyn::vehicle
