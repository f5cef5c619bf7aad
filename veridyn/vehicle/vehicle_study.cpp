#include "veridyn/vehicle/drive_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "veridyn/core/error.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/recording/study_data.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::vehicle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Cornering stiffness over static load of common tyres [1/rad].
constexpr double kStiffnessPerLoad = 20.0;
/// Noise of the sensors is learned from the beginning of a drive [s].
constexpr double kLearn_s = 20.0;
/// Read again before the first new sample, for the interpolation [s].
constexpr double kWarm_s = 2.0;

DriveStudy read_tables(const Study& study) {
  const StudyTable& root = study.root();
  DriveStudy out;
  out.name = root.text_or("title", study.name());
  out.seed = static_cast<std::uint64_t>(root.integer_or("seed", 1));
  const StudyTable subject = root.table("subject");
  const Vehicle vehicle = read_vehicle(subject, VehicleNeeds::kGeometry);
  out.subject_name = vehicle.name.empty() ? "vehicle" : vehicle.name;
  out.vehicle = vehicle.parameters;
  out.inputs = vehicle.inputs;
  out.signals = DriveSignalOptions::read(root.table_or_empty("signals"));
  VehicleParameters<double>& p = out.vehicle;
  const bool known = subject.has("builtin");
  if (!known && !subject.has("I_z")) p.I_z = p.mass * p.a * p.b;
  const PerWheel<double> load = static_loads(p, out.signals.gravity);
  if (!known && !subject.has("C_f")) p.C_f = kStiffnessPerLoad * load[kFrontLeft];
  if (!known && !subject.has("C_r")) p.C_r = kStiffnessPerLoad * load[kRearLeft];
  out.segments = DriveSegmentOptions::read(root.table_or_empty("segments"));
  out.identify = VehicleIdentifyOptions::read(root.table_or_empty("identify"));
  out.identify.model.gravity = out.signals.gravity;
  out.track = DriveTrackOptions::read(root.table_or_empty("track"));
  const std::vector<std::string> choices{"all", "holdout"};
  out.validate_on_holdout_only = root.table_or_empty("validate").choice_or("segments", choices, "all") == "holdout";
  return out;
}

std::vector<std::string> own_warnings(const DriveStudy& study, const DriveSignals& signals) {
  std::vector<std::string> warnings = study.log.mapped.recording.warnings;
  const auto add = [&](const std::vector<std::string>& more) {
    warnings.insert(warnings.end(), more.begin(), more.end());
  };
  add(study.log.mapped.notes);
  add(signals.notes);
  add(study.notes);
  return warnings;
}

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

DriveStudy read_drive_study(const Study& study, Progress& progress) {
  DriveStudy out = read_tables(study);
  const StudyTable& root = study.root();
  if (!root.has("data")) root.fail("data", "is missing: the study names no recording of a drive");
  progress.stage("reading the recording");
  out.log = read_drive_log(root.table("data"));
  out.inputs.insert(out.inputs.end(), out.log.inputs.begin(), out.log.inputs.end());
  return out;
}

DriveStudy read_drive_study(const Study& study, const Recording& recording, Progress& /*progress*/) {
  DriveStudy out = read_tables(study);
  const StudyTable data = study.root().table_or_empty("data");
  out.log.mapped = map_drive_channels(recording, data.table_or_empty("map"), data.text_or("frame", ""),
                                      data.has("frame") ? data.place("frame") : std::string());
  out.log.runs = {recording.span()};
  return out;
}

DriveAnalysis identify_drive(DriveStudy& study, Progress& progress) {
  DriveAnalysis out;
  out.signals = prepare_drive_signals(study.log.mapped, study.signals);
  out.segments = find_drive_segments(out.signals, study.segments, study.log.holdout_runs);
  out.identification =
      identify_vehicle(out.signals, out.segments, study.vehicle, study.signals, study.identify, progress);
  out.interrupted = out.identification.interrupted;
  std::vector<std::string> warnings = own_warnings(study, out.signals);
  if (!out.signals.gravity_removed && out.signals[DriveSignal::kAccelY].available() &&
      !study.identify.model.free[static_cast<std::size_t>(DriveUnknown::kAccelYScale)]) {
    warnings.emplace_back(
        "accel_y is taken as it is: where the sensor leans with the body it shows g sin(roll) too (5 deg of roll per g "
        "make 8.7 % of it); give signals.roll_gradient, record roll, or estimate accel_y_scale");
  }
  warnings.insert(warnings.end(), out.identification.warnings.begin(), out.identification.warnings.end());
  out.identification.warnings = std::move(warnings);
  out.estimate = make_vehicle_estimate(out.identification, study.subject_name);
  return out;
}

DriveAnalysis validate_drive(DriveStudy& study, const estimation::Estimate& estimate, Progress& progress) {
  DriveAnalysis out;
  out.signals = prepare_drive_signals(study.log.mapped, study.signals);
  out.segments = find_drive_segments(out.signals, study.segments, study.log.holdout_runs);
  progress.stage("validating");
  std::vector<TimeSpan> spans = study.validate_on_holdout_only ? out.segments.holdout : out.segments.identification;
  if (!study.validate_on_holdout_only)
    spans.insert(spans.end(), out.segments.holdout.begin(), out.segments.holdout.end());
  std::sort(spans.begin(), spans.end(), [](const TimeSpan& x, const TimeSpan& y) { return x.begin < y.begin; });
  VehicleIdentification& id = out.identification;
  VehicleParameters<double> p = study.vehicle;
  DriveModelOptions model = study.identify.model;
  std::vector<std::string> missing;
  const auto take = [&](const char* name, double& to) {
    const estimation::EstimatedParameter* e = estimate.find(name);
    if (e != nullptr && std::isfinite(e->value))
      to = e->value;
    else if (std::string_view(name) == "C_f" || std::string_view(name) == "C_r" || std::string_view(name) == "I_z")
      missing.emplace_back(name);
  };
  take("C_f", p.C_f);
  take("C_r", p.C_r);
  take("I_z", p.I_z);
  const double L = p.wheelbase();
  take("a", p.a);
  p.b = L - p.a;
  for (const DriveUnknown u : {DriveUnknown::kMu, DriveUnknown::kShape, DriveUnknown::kCurvature,
                               DriveUnknown::kSteerScale, DriveUnknown::kAccelYScale, DriveUnknown::kSteerDelay,
                               DriveUnknown::kYawRateDelay, DriveUnknown::kAccelYDelay}) {
    const auto i = static_cast<std::size_t>(u);
    take(std::string(kDriveUnknownNames[i]).c_str(), model.start[i]);
  }
  if (estimate.find("mu") != nullptr) model.tyre = DriveTyre::kMagicFormula;
  if (!missing.empty()) {
    std::string text = missing[0];
    for (std::size_t i = 1; i < missing.size(); ++i) text += ", " + missing[i];
    throw InputError("estimate", fmt::format("has no {}; without it no drive can be predicted", text));
  }
  id.chosen = estimate.method;
  id.identified = p;
  VehicleEstimate given;
  given.method = estimate.method;
  given.usable = true;
  given.covariance = estimate.covariance;
  for (const estimation::EstimatedParameter& e : estimate.parameters) {
    estimation::ParameterEstimate q;
    q.name = e.name;
    q.unit = e.unit;
    q.value = e.value;
    q.sigma = e.sigma;
    q.low95 = e.low95;
    q.high95 = e.high95;
    q.status = e.status;
    given.parameters.push_back(std::move(q));
  }
  id.estimates.push_back(std::move(given));
  if (spans.empty()) {
    id.verdict = VehicleVerdict::kNotExcited;
    id.reason = fmt::format("the estimate cannot be judged: {}", out.segments.text);
  } else {
    const Eigen::VectorXd theta = fit_drive_biases(out.signals, spans, p, model);
    const auto n = static_cast<Eigen::Index>(kDriveUnknowns);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t i = 0; i < estimate.parameters.size(); ++i) {
      for (std::size_t j = 0; j < estimate.parameters.size(); ++j) {
        const auto at = [&](std::size_t k) {
          return std::find(kDriveUnknownNames.begin(), kDriveUnknownNames.end(), estimate.parameters[k].name) -
                 kDriveUnknownNames.begin();
        };
        const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
        if (at(i) >= n || at(j) >= n || row >= estimate.covariance.rows() || column >= estimate.covariance.cols())
          continue;
        const double c = estimate.covariance(row, column);
        if (std::isfinite(c)) covariance(at(i), at(j)) = c;
      }
    }
    id.validation = predict_drive(out.signals, spans, p, model, theta, covariance);
    const PredictedDriveQuantity* r = id.validation.find("yaw_rate");
    const bool holds = r != nullptr && r->fit.r2 >= study.identify.min_holdout_r2;
    id.verdict = holds ? VehicleVerdict::kIdentified : VehicleVerdict::kRejected;
    id.reason = r == nullptr ? fmt::format("does not hold: {}", id.validation.text)
                             : fmt::format("{}: it explains {:.1f} % of the yaw rate's variance of this drive",
                                           holds ? "holds" : "does not hold", 100.0 * std::max(0.0, r->fit.r2));
  }
  id.warnings = own_warnings(study, out.signals);
  id.warnings.emplace_back("constant biases of steering, yaw rate and accel_y were fitted to this drive");
  out.interrupted = progress.interrupted();
  out.estimate = make_vehicle_estimate(id, study.subject_name);
  out.estimate.parameters = estimate.parameters;
  out.estimate.covariance = estimate.covariance;
  out.estimate.method = estimate.method;
  return out;
}

TrackedDrive::TrackedDrive(const DriveStudy& study)
    : subject_(study.subject_name),
      start_(study.vehicle),
      options_(study.track),
      signals_(study.signals),
      min_speed_(study.segments.min_speed_mps) {
  if (!options_.estimate_file.empty()) begin_ = io::read_estimate(options_.estimate_file);
}

std::vector<DriveChange> TrackedDrive::advance(const recording::MappedRecording& mapped, bool finished, Progress& progress) {
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

DriveTracking track_drive(DriveStudy& study, Progress& progress) {
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
  for (std::size_t i = 0; i < kTrackedAxles; ++i) {
    const DriveTrackHistory& h = tracker.history(static_cast<TrackedAxle>(i));
    if (h.time.empty()) continue;
    const std::string name(kTrackedAxleNames[i]);
    const std::string unit(i < 2 ? "N/rad" : "rad s^2/m");
    const TimeBase time = make_time_base(h.time);
    const auto add = [&](std::string channel, const std::string& of, std::vector<double> values) {
      for (double& v : values) {
        if (std::isinf(v)) v = std::numeric_limits<double>::quiet_NaN();
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
