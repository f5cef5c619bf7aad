#include "veridyn/vehicle/track_drive.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/modulating_kernel.hpp"
#include "veridyn/recording/study_data.hpp"
#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"

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

/// What the accelerometer shows of a lean.
LeaningSensor leaning_sensor(const DriveSignals& signals, double gravity) {
  return {.gravity = signals.gravity_removed ? 0.0 : gravity, .height = signals.accel_position[2]};
}

}  // namespace

TrackedDrive::TrackedDrive(const VehicleStudy& study)
    : subject_(study.subject_name),
      start_(study.vehicle),
      options_(study.track),
      signals_(study.signals),
      segments_(study.segments),
      identify_(study.identify) {
  if (!options_.estimate_file.empty()) begin_ = io::read_estimate(options_.estimate_file);
}

bool TrackedDrive::learns_body() const {
  // An estimate without a yaw inertia is that of a tracked drive.
  return options_.learning_s > 0.0 && !(begin_ && begin_->find("I_z") != nullptr);
}

void TrackedDrive::begin(const recording::MappedRecording& mapped, Progress& progress) {
  const double from = mapped.recording.span().begin;
  recording::MappedRecording part = mapped;
  part.recording = recording::cut(mapped.recording, {from, from + kLearn_s});
  const DriveSignals first = prepare_drive_signals(part, signals_);
  require_accel(first);
  notes_ = first.notes;
  // The rate is kept, whatever later parts would suggest.
  signals_.rate_Hz = first.grid.rate_Hz();
  DriveTrackStart start{.vehicle = start_, .sensor = leaning_sensor(first, signals_.gravity)};
  if (begin_) {
    start.estimate = &*begin_;
    start.body = known_body(*begin_, start_, identify_.model);
  }
  if (learns_body()) {
    progress.stage("learning the body from the beginning");
    part.recording = recording::cut(mapped.recording, {from, from + options_.learning_s});
    KnownBody learned =
        learned_body(prepare_drive_signals(part, signals_), segments_, start_, signals_, identify_, progress);
    if (learned.source != BodySource::kNone || !begin_) start.body = std::move(learned);
  }
  const std::array<double, 4> noise{first[DriveSignal::kSteer].sigma, first[DriveSignal::kSpeed].sigma,
                                    first[DriveSignal::kYawRate].sigma, first[DriveSignal::kAccelY].sigma};
  tracker_.emplace(start, options_, segments_.min_speed_mps, signals_.rate_Hz, noise);
}

std::vector<DriveChange> TrackedDrive::advance(const recording::MappedRecording& mapped, bool finished,
                                               Progress& progress) {
  std::vector<DriveChange> found;
  const TimeSpan span = mapped.recording.span();
  if (!tracker_) {
    const double needed = learns_body() ? std::max(kLearn_s, options_.learning_s) : kLearn_s;
    if (!finished && span.duration() < needed) return found;
    begin(mapped, progress);
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
  if (finished && !progress.interrupted()) check(mapped, progress);
  return found;
}

void TrackedDrive::check(const recording::MappedRecording& mapped, const Progress& progress) {
  const DriveSignals signals = prepare_drive_signals(mapped, signals_);
  DriveSegments segments;
  try {
    segments = find_drive_segments(signals, segments_);
  } catch (const InputError&) {
    // Nothing of it is usable: that no axle is excited says so.
    return;
  }
  const KnownBody& body = tracker_->body();
  KnownByModel known{.changed = !tracker_->changes().empty()};
  if (body.roll.gradient > 0.0) known.roll_gradient = body.roll.gradient;
  recording_ = recording_rows(drive_findings(mapped, signals, segments, tracker_->start(), signals_, progress), known);
}

estimation::Estimate TrackedDrive::estimate() const {
  if (tracker_) {
    estimation::Estimate out = tracker_->estimate(subject_, recording_);
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
