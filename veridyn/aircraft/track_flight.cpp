#include "veridyn/aircraft/track_flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/evidence/recording_evidence.hpp"
#include "veridyn/aircraft/identification/signals/direct_air_data.hpp"
#include "veridyn/aircraft/identification/signals/excited_segments.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"
#include "veridyn/aircraft/tracking/tracking_judgement.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/recording/study_data.hpp"

namespace veridyn::aircraft {
namespace {

/// Seconds read again before the first new row: filters need some, the state estimate finds its wind in them.
constexpr double kWarmSensors_s = 3.0;
constexpr double kWarmFilter_s = 90.0;
/// Less than this is not worth a pass.
constexpr double kShortest_s = 1.0;

FlightTracker make_tracker(const FlightStudy& study) {
  std::optional<estimation::Estimate> start;
  if (!study.track.estimate_file.empty()) start = io::read_estimate(study.track.estimate_file);
  return FlightTracker(study.subject, study.track, study.segments.min_airspeed_mps, start ? &*start : nullptr);
}

/// The model-free filter's options: no model may have a say in the rows that models are estimated from.
ReconstructOptions rows_options(const FlightStudy& study) {
  ReconstructOptions options = study.reconstruct;
  options.filter = FilterKind::kModelFree;
  return options;
}

void check_filters(const FlightStudy& study) {
  const ReconstructOptions& o = study.reconstruct;
  if (o.filter == FilterKind::kModelBased || o.filter == FilterKind::kGuarded) {
    throw InputError(study.name,
                     fmt::format("reconstruct.filter = \"{}\" contradicts tracking: rows that were filtered "
                                 "with a model would confirm that model; leave it out; track.filter = "
                                 "\"guarded\" runs a model-based filter alongside the tracker",
                                 to_string(o.filter)));
  }
  if (study.track.filter == TrackFilter::kGuarded && o.estimates_air_data_errors()) {
    throw InputError(study.name,
                     "track.filter = \"guarded\" contradicts errors of vanes and pitot tube in "
                     "reconstruct.estimate, which need the whole flight");
  }
}

}  // namespace

TrackedFlight::TrackedFlight(const FlightStudy& study) : tracker_(make_tracker(study)) {
  check_filters(study);
  if (study.track.filter != TrackFilter::kGuarded) return;
  model_.emplace(study.filter_subject ? *study.filter_subject : study.subject, study.track, study.reconstruct);
  filter_.add_model(model_->start());
}

std::vector<FlightChange> TrackedFlight::feed(const FlightSignals& signals, double from, double until) {
  if (!model_) return tracker_.feed(signals, from, until);
  // The tracker takes its rows in windows by the clock: a stop at the end of each changes nothing for it.
  constexpr double kWindow = FlightTracker::kWindowSeconds;
  std::vector<FlightChange> found;
  double begin = std::max(from, signals.grid.begin);
  if (std::isfinite(tracker_.last_time())) begin = std::max(begin, tracker_.last_time());
  const double last = std::min(until, signals.grid.at(signals.size() - 1));
  for (double end = (std::floor(begin / kWindow) + 1.0) * kWindow; end <= last; end += kWindow) {
    const std::vector<FlightChange> some = tracker_.feed(signals, from, std::nextafter(end, 0.0));
    found.insert(found.end(), some.begin(), some.end());
    // The last row of the window needs what comes half a filter's width later.
    if (auto model = model_->look(tracker_, end + filter_margin(signals))) filter_.add_model(std::move(*model));
  }
  const std::vector<FlightChange> rest = tracker_.feed(signals, from, until);
  found.insert(found.end(), rest.begin(), rest.end());
  return found;
}

void TrackedFlight::run_filter(const Recording& part, const FlightStudy& study, const Recording& model_free,
                               const DrydenSettings& turbulence, Progress& progress) {
  const std::vector<FilterModel>& given = filter_.models();
  const std::vector<TimedModel> models(given.begin(), given.end());
  filter_.append(replay_guarded(part, study.reconstruct, study.subject, models, turbulence, progress), model_free);
}

std::vector<FlightChange> TrackedFlight::advance(const MappedRecording& mapped, const FlightStudy& study, bool finished,
                                                 Progress& progress, std::span<const DelayReport> delays) {
  const std::vector<std::string> needed{"gyro_x", "gyro_y", "gyro_z"};
  require_channels(mapped, needed, "tracking");
  const TimeSpan span = mapped.recording.at("gyro_x").span();
  end_ = std::max(end_, span.end);
  // Where no filter can run, the sensors themselves are what there is.
  const bool by_sensors = study.track.air_data == AirDataSource::kSensors ||
                          study.reconstruct.filter == FilterKind::kNone ||
                          !reconstruction_obstacle(mapped.recording, study.reconstruct).empty();
  air_data_ = by_sensors ? AirDataSource::kSensors : AirDataSource::kFilter;
  const double begin = std::isfinite(tracker_.last_time())
                           ? tracker_.last_time() - (by_sensors ? kWarmSensors_s : kWarmFilter_s)
                           : span.begin;
  if (!(span.end - std::max(begin, span.begin) >= kShortest_s)) return {};

  MappedRecording part = mapped;
  const bool whole = begin <= span.begin;
  if (!whole) part.recording = recording::cut(mapped.recording, {begin, kInfinity});
  Recording air;
  std::optional<Reconstruction> reconstruction;
  if (by_sensors) {
    air = direct_air_data(part.recording, study.reconstruct, study.signals);
  } else {
    ReconstructOptions options = rows_options(study);
    options.keep_filter = true;
    reconstruction = reconstruct(part.recording, options, progress);
    if (reconstruction->interrupted) return {};
    // Nothing is learnt from dead reckoning.
    if (reconstruction->contradiction) {
      notes_ = {reconstruction->contradiction->statement};
      if (reconstruction->filtered.channels().empty()) return {};
    }
    air = std::move(reconstruction->filtered);
  }
  const SensorSigma known = internal::load_streams(part.recording, study.reconstruct).sigma;
  const FlightSignals signals =
      prepare_signals(part, air, flow_sensors(study.reconstruct, air), study.subject, study.signals,
                      study.reconstruct.sensors == NoiseSource::kReference ? &known : nullptr);
  if (tracker_.rows() == 0 && notes_.empty()) notes_ = signals.notes;
  if (whole && finished && reconstruction) judge_recording(part, study, *reconstruction, signals, delays);
  const double margin = filter_margin(signals);
  std::vector<FlightChange> found =
      feed(signals, whole ? -kInfinity : begin + margin, finished ? kInfinity : span.end - margin);
  if (model_) run_filter(part.recording, study, air, reconstruction->turbulence, progress);
  return found;
}

void TrackedFlight::judge_recording(const MappedRecording& mapped, const FlightStudy& study,
                                    const Reconstruction& reconstruction, const FlightSignals& signals,
                                    std::span<const DelayReport> delays) {
  recording_evidence_ =
      recording_evidence(mapped.recording, reconstruction, study.reconstruct, excited_segments(signals, study.segments),
                         delays, 0, {}, study.subject.imu_position)
          .rows;
}

void TrackedFlight::check_recording(const MappedRecording& mapped, const FlightStudy& study,
                                    std::span<const DelayReport> delays, Progress& progress) {
  if (!recording_evidence_.empty()) return;
  progress.stage("checking the recording");
  const bool filter = study.reconstruct.filter != FilterKind::kNone &&
                      reconstruction_obstacle(mapped.recording, study.reconstruct).empty();
  const Reconstruction reconstruction = filter ? reconstruct(mapped.recording, study.reconstruct, progress)
                                               : recorded_motion(mapped.recording, study.reconstruct, study.signals);
  if (reconstruction.interrupted) return;
  judge_recording(
      mapped, study, reconstruction,
      prepare_signals(mapped, reconstruction.smoothed, flow_sensors(study.reconstruct, reconstruction.smoothed),
                      study.subject, study.signals),
      delays);
}

estimation::Estimate TrackedFlight::estimate() const { return judged_estimate(tracker_, recording_evidence_); }

TrackingAnalysis track_flight(const FlightStudy& study, Progress& progress) {
  progress.stage("aligning sensor delays");
  const AlignedRecording aligned = align_delays(
      study.mapped, internal::alignment_of(study.mapped.recording, study.delays, study.reconstruct), progress);
  TrackingAnalysis analysis{aligned.delays, TrackedFlight(study), false};
  progress.stage("tracking");
  static_cast<void>(analysis.flight.advance(aligned.mapped, study, true, progress, aligned.delays));
  analysis.flight.check_recording(aligned.mapped, study, aligned.delays, progress);
  analysis.interrupted = progress.interrupted();
  return analysis;
}

Recording history_recording(const FlightTracker& tracker) {
  Recording out;
  out.source = "track.csv";
  out.frame = Frame::kFrd;
  for (const TrackedCoefficient& c : tracker.coefficients()) {
    if (!c.tracker) continue;
    const TrackHistory& h = c.tracker->history();
    const std::string name(name_of(c.model.coefficient));
    const TimeBase time = make_time_base(h.time);
    const auto add = [&](std::string channel, std::vector<double> values) {
      // Before an estimate is usable its error bar is infinite: an empty cell.
      for (double& v : values) {
        if (std::isinf(v)) v = kNaN;
      }
      out.add(make_channel(std::move(channel), "1", time, std::move(values)));
    };
    for (std::size_t i = 0; i < c.model.size(); ++i) {
      add(c.tracker->names()[i], h.value[i]);
      add("sigma_" + c.tracker->names()[i], h.sigma[i]);
    }
    for (std::size_t i = 0; i < h.singular_value.size(); ++i)
      add(fmt::format("singular_value_{}_{}", name, i + 1), h.singular_value[i]);
    add("threshold_" + name, h.threshold);
    add("excited_" + name, {h.excited.begin(), h.excited.end()});
    add("lambda_" + name, h.lambda);
    add("innovation_" + name, h.innovation);
    add("suspicion_" + name, h.suspicion);
  }
  return out;
}

}  // namespace veridyn::aircraft
