#include "veridyn/aircraft/aircraft_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/contradicted_flight.hpp"
#include "veridyn/aircraft/identification/direct_air_data.hpp"
#include "veridyn/aircraft/identification/excited_segments.hpp"
#include "veridyn/aircraft/identification/parameter_groups.hpp"
#include "veridyn/aircraft/identification/recording_evidence.hpp"
#include "veridyn/aircraft/model/estimated_subject.hpp"
#include "veridyn/aircraft/reconstruction/filter_comparison.hpp"
#include "veridyn/aircraft/sensors/air_data_calibration.hpp"
#include "veridyn/aircraft/simulation/simulate_study.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/recording/study_data.hpp"

namespace veridyn::aircraft {
namespace {

/// Lift coefficient that few wings exceed: at 0.8 of the speed that it gives, nothing flies.
constexpr double kHighLift = 1.2;

double least_flying_airspeed(const Subject& subject) {
  return 0.8 * std::sqrt(2.0 * subject.mass * kGravity / (1.225 * subject.wing_area * kHighLift));
}

SurfaceThrows throws_of(const Subject& subject, const StudyTable& table) {
  const bool known = table.has("builtin") || table.table_or_empty("actuators").has("elevator");
  return {.elevator = subject.elevator.upper,
          .aileron = subject.aileron.upper,
          .rudder = subject.rudder.upper,
          .known = known};
}

/// Highest airspeed, or ground speed where there is no pitot tube.
std::pair<double, std::string> highest_speed(const Recording& recording) {
  double highest = 0.0;
  if (const Channel* airspeed = recording.find("airspeed")) {
    for (const double v : airspeed->value) highest = std::fmax(highest, v);
    return {highest, "airspeed"};
  }
  if (const Channel* pressure = recording.find("dynamic_pressure")) {
    for (const double q : pressure->value) highest = std::fmax(highest, std::sqrt(2.0 * std::fmax(0.0, q) / 1.225));
    return {highest, "airspeed"};
  }
  if (!recording.has("vel_north") || !recording.has("vel_east")) return {0.0, "speed"};
  const Channel& north = recording.at("vel_north");
  const Channel& east = recording.at("vel_east");
  for (std::size_t i = 0; i < std::min(north.size(), east.size()); ++i) {
    highest = std::fmax(highest, std::hypot(north.value[i], east.value[i]));
  }
  return {highest, "ground speed"};
}

/// What every analysis needs, refused in one sentence when it is missing.
void check_flight(const FlightStudy& study) {
  const std::vector<std::string> gyro_axes{"gyro_x", "gyro_y", "gyro_z"};
  require_channels(study.mapped, gyro_axes, "the analysis of a flight");
  const Recording& recording = study.mapped.recording;
  const bool airspeed = recording.has("airspeed") || recording.has("dynamic_pressure");
  const bool without_filter = study.reconstruct.filter == FilterKind::kNone;
  const std::string obstacle = reconstruction_obstacle(recording, study.reconstruct);
  if (!airspeed && (without_filter || !obstacle.empty()))
    throw InputError(recording.source,
                     fmt::format("{}; it has: {}",
                                 without_filter ? "reconstruct.filter = \"none\" needs an airspeed (airspeed, "
                                                  "dynamic_pressure)"
                                                : obstacle + ", and no airspeed to do without a filter",
                                 fmt::join(recording.names(), ", ")));
  constexpr double kSlowest_Hz = 2.0;
  if (const Channel& gyro = study.mapped.recording.at("gyro_x"); !(gyro.rate_Hz() > kSlowest_Hz)) {
    throw InputError(study.mapped.recording.source,
                     fmt::format("its gyro has a sample every {:.3g} s, too few to follow a flight: check the unit of "
                                 "time (data.time.unit)",
                                 1.0 / gyro.rate_Hz()));
  }
  const double least = study.segments.min_airspeed_mps;
  const auto [highest, what] = highest_speed(study.mapped.recording);
  if (!(highest > least)) {
    throw InputError(
        study.mapped.recording.source,
        fmt::format(
            "the aircraft never flies: the {} stays below {:.1f} m/s, {} needs {:.1f} m/s (key segments.min_airspeed)",
            what, std::ceil(10.0 * highest) / 10.0, study.subject.name, least));
  }
}

/// By the filter, or as recorded: where that is asked for, and where no filter can run.
Reconstruction motion_of(const Recording& recording, const ReconstructOptions& options, const SignalOptions& signals,
                         Progress& progress, const Subject& model) {
  if (options.filter == FilterKind::kNone) return recorded_motion(recording, options, signals);
  const std::string obstacle = reconstruction_obstacle(recording, options);
  if (obstacle.empty() || options.filter != FilterKind::kModelFree)
    return reconstruct(recording, options, progress, &model);
  Reconstruction motion = recorded_motion(recording, options, signals);
  motion.warnings.insert(motion.warnings.begin(), fmt::format("{}: no filter can run", obstacle));
  return motion;
}

/// Delays and motion through the air.
FlightAnalysis reconstruct_with(const FlightStudy& study, const ReconstructOptions& options, Progress& progress) {
  check_flight(study);
  progress.stage("aligning sensor delays");
  AlignedRecording aligned = align_delays(study.mapped, study.delays, progress);
  FlightAnalysis analysis;
  analysis.aligned = std::move(aligned.mapped);
  analysis.delays = std::move(aligned.delays);
  analysis.interrupted = progress.interrupted();
  if (analysis.interrupted) return analysis;
  const Recording& recording = analysis.aligned.recording;
  const Subject& model = study.filter_subject ? *study.filter_subject : study.subject;
  analysis.reconstruction = motion_of(recording, options, study.signals, progress, model);
  const bool by_model = options.filter == FilterKind::kModelBased || options.filter == FilterKind::kGuarded;
  if (study.truth && options.compare && by_model) {
    progress.stage("comparing the filters with the truth");
    analysis.reconstruction.comparison = compare_filters(recording, *study.truth, options, model, progress);
  }
  analysis.interrupted = analysis.reconstruction.interrupted;
  return analysis;
}

/// What identification and validation share: from recording to signals and segments.
FlightAnalysis analyse_motion(const FlightStudy& study, Progress& progress) {
  ReconstructOptions options = study.reconstruct;
  // The filter's estimate is only compared with the truth, where there is one; an hour of it takes 150 MB.
  options.keep_filter = study.truth.has_value();
  FlightAnalysis analysis = reconstruct_with(study, options, progress);
  if (analysis.interrupted) return analysis;
  if (analysis.reconstruction.contradiction) {
    progress.stage("checking the recording");
    analysis.segments = recorded_flight(analysis.aligned.recording, study.segments.min_airspeed_mps);
    analysis.recording_evidence = recording_evidence(analysis.aligned.recording, analysis.reconstruction, options,
                                                     analysis.segments, analysis.delays);
    return analysis;
  }
  const bool data_sheet = options.sensors == NoiseSource::kReference;
  analysis.signals = prepare_signals(analysis.aligned, analysis.reconstruction.smoothed, study.subject, study.signals,
                                     data_sheet ? &analysis.reconstruction.sigma : nullptr);
  analysis.segments = excited_segments(analysis.signals, study.segments);
  progress.stage("checking the recording");
  analysis.recording_evidence = recording_evidence(analysis.aligned.recording, analysis.reconstruction, options,
                                                   analysis.segments, analysis.delays);
  return analysis;
}

std::vector<std::string> names_with(std::span<const CoefficientResult> results, estimation::GroupVerdict verdict) {
  std::vector<std::string> names;
  for (const CoefficientResult& result : results) {
    if (result.verdict == verdict) names.push_back(result.name);
  }
  return names;
}

/// One clause for each verdict: "identified: CL, Cm; rejected: CD".
std::string verdict_text(std::span<const CoefficientResult> results) {
  std::vector<std::string> parts;
  for (const estimation::GroupVerdict verdict :
       {estimation::GroupVerdict::kIdentified, estimation::GroupVerdict::kEffective,
        estimation::GroupVerdict::kRejected, estimation::GroupVerdict::kNotExcited,
        estimation::GroupVerdict::kSkipped}) {
    const std::vector<std::string> names = names_with(results, verdict);
    if (!names.empty()) parts.push_back(fmt::format("{}: {}", to_string(verdict), fmt::join(names, ", ")));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

std::vector<std::string> warnings_of(const FlightStudy& study, const FlightAnalysis& analysis) {
  std::vector<std::string> warnings;
  for (const auto* texts : {&study.subject.warnings, &study.mapped.recording.warnings, &study.mapped.notes,
                            &analysis.reconstruction.warnings, &analysis.signals.notes}) {
    warnings.insert(warnings.end(), texts->begin(), texts->end());
  }
  if (!study.subject.inertia) {
    warnings.emplace_back(
        "without subject.inertia the moments are identified per unit inertia (Cl/Jx, Cm/Jy, Cn/Jz), with the inertial "
        "coupling of a flat body (Jz = Jx + Jy, Jx = Jy, Jxz = 0) and the moments of the thrust left in");
  }
  for (const CoefficientResult& result : analysis.coefficients) {
    if (result.verdict != estimation::GroupVerdict::kIdentified) warnings.push_back(result.reason);
  }
  return warnings;
}

/// Flown open loop over held-out data, the model must be nearer than the mean of what was flown.
std::vector<estimation::Evidence> flown_evidence(const Validation& validation) {
  using namespace estimation;
  std::vector<Evidence> rows;
  for (const PredictedQuantity& q : validation.quantities) {
    const bool better = q.fit.r2 >= 0.0;
    // Gusts, which the model is not given, can cost a good one its lead over the mean; they do not make it miss by
    // three times what the motion varies.
    const Outcome outcome = better ? Outcome::kPassed : q.fit.r2 >= -10.0 ? Outcome::kCare : Outcome::kFailed;
    rows.push_back({.name = "flown over the hold-out",
                    .about = q.name,
                    .outcome = outcome,
                    .value = q.fit.r2,
                    .limit = 0.0,
                    .scale = "R2",
                    .text = fmt::format(
                        "flown for {:.0f} s at a time over the hold-out, the model misses {} by {:.2g} {}{}",
                        validation.period_s, q.name, q.fit.mae, q.unit, better ? "" : ", which is worse than its mean"),
                    .bears_on = Purpose::kPrediction});
    const bool beats_last = q.fit.rmse <= q.last_value_rmse;
    rows.push_back({.name = "flown against the last value",
                    .about = q.name,
                    .outcome = passed_or(beats_last, Outcome::kCare),
                    .value = q.fit.rmse / q.last_value_rmse,
                    .limit = 1.0,
                    .scale = "error over that of the last value",
                    .text = fmt::format("the model's error in {} is {:.2f} times that of who holds the value at the "
                                        "start of each window{}",
                                        q.name, q.fit.rmse / q.last_value_rmse,
                                        beats_last ? "" : ": it predicts no better than that"),
                    .bears_on = Purpose::kPrediction});
  }
  return rows;
}

std::vector<estimation::Evidence> rows_of(std::span<const FlightEvidence> evidence) {
  std::vector<estimation::Evidence> rows;
  for (const FlightEvidence& e : evidence) rows.push_back(e.row);
  return rows;
}

/// The grades of the coefficients together, and of what bears on all of them.
estimation::Judgement judgement_of(const FlightAnalysis& analysis, std::span<const estimation::Evidence> of_all) {
  std::vector<estimation::Judgement> parts;
  for (const CoefficientResult& result : analysis.coefficients) parts.push_back(result.judgement);
  const estimation::Judgement coefficients = estimation::judge_together(parts);
  const estimation::Judgement whole = estimation::judge(of_all);
  estimation::Judgement judgement = coefficients;
  judgement.data = whole.data;
  judgement.prediction = estimation::worse(coefficients.prediction, whole.prediction);
  return judgement;
}

/// What estimate.json will say of an analysis that is complete but for it.
estimation::Estimate summarise(const FlightStudy& study, const FlightAnalysis& analysis) {
  estimation::Estimate estimate = make_estimate(study.subject, analysis.coefficients);
  for (const OtherParameter& other : analysis.others.parameters) estimate.other_methods.push_back(other.estimate);
  estimate.verdict = verdict_text(analysis.coefficients);
  for (const PredictedQuantity& q : analysis.validation.quantities) {
    estimate.validation[q.name] = {q.fit.mae, q.fit.rmse, q.fit.r2, q.fit.theil, q.unit};
  }
  estimate.warnings = warnings_of(study, analysis);
  std::vector<estimation::Evidence> of_all = rows_of(analysis.recording_evidence);
  const std::vector<estimation::Evidence> flown = flown_evidence(analysis.validation);
  of_all.insert(of_all.end(), flown.begin(), flown.end());
  estimate.judgement = judgement_of(analysis, of_all);
  estimate.evidence = std::move(of_all);
  for (const CoefficientResult& result : analysis.coefficients) {
    for (const estimation::Evidence& row : result.evidence) {
      const bool of_parameter = result.chosen && result.chosen->find(row.about) != nullptr;
      if (row.about == result.name || of_parameter) estimate.evidence.push_back(row);
    }
  }
  return estimate;
}

/// The results in the terms that all domains share.
FlightAnalysis with_results(FlightAnalysis analysis, const FlightStudy& study, const Progress& progress) {
  analysis.estimate = summarise(study, analysis);
  analysis.groups = parameter_groups(analysis.coefficients, analysis.others);
  analysis.predictions = predictions(analysis.validation.quantities, analysis.coefficients);
  if (study.true_subject) analysis.truth = true_values(*study.true_subject, study.subject, analysis.coefficients);
  analysis.interrupted = progress.interrupted();
  return analysis;
}

/// What is left to say where the motion could not be reconstructed: the rows of the recording.
FlightAnalysis without_motion(FlightAnalysis analysis, const FlightStudy& study, const Progress& progress) {
  analysis.coefficients = not_identified(study.subject, study.identify, *analysis.reconstruction.contradiction,
                                         analysis.recording_evidence);
  analysis.identified = identified_subject(study.subject, analysis.coefficients);
  return with_results(std::move(analysis), study, progress);
}

}  // namespace

FlightStudy read_study(const Study& study, Progress& progress) {
  const StudyTable& root = study.root();
  FlightStudy result;
  result.name = study.name();
  result.seed = static_cast<std::uint64_t>(root.integer_or("seed", 1));
  static_cast<void>(root.text_or("title", ""));
  const StudyTable subject = root.table("subject");
  result.subject = read_subject(subject);
  result.delays = DelayAlignment::read(root.table_or_empty("delays"));
  result.reconstruct = ReconstructOptions::read(root.table_or_empty("reconstruct"));
  if (const std::filesystem::path& estimate = result.reconstruct.estimate_file; !estimate.empty())
    result.filter_subject = estimated_subject(result.subject, io::read_estimate(estimate), estimate.string());
  result.signals = SignalOptions::read(root.table_or_empty("signals"));
  result.segments = SegmentOptions::read(root.table_or_empty("segments"));
  result.identify = IdentifyOptions::read(root.table_or_empty("identify"));
  result.identify.seed = result.seed;
  result.validate = ValidationOptions::read(root.table_or_empty("validate"));
  result.track = TrackOptions::read(root.table_or_empty("track"));
  result.uncertainty = UncertaintyOptions::read(root.table_or_empty("uncertainty"));
  if (!(result.segments.min_airspeed_mps > 0.0))
    result.segments.min_airspeed_mps = least_flying_airspeed(result.subject);

  const StudyTable data = root.table_or_empty("data");
  const StudyTable map = data.table_or_empty("map");
  Recording log;
  if (!root.has("data")) {
    if (!root.has("flight")) root.fail("data", "is missing: the study names no recording, and no [flight] to simulate");
    const SimulationOptions simulation = read_simulation(root);
    root.finish();
    progress.stage("simulating the flight");
    SimulatedFlight flight = simulate(simulation, progress);
    if (!flight.usable()) throw InputError(study.name(), flight.message());
    log = std::move(flight.measured);
    log.source = study.name();
    result.truth = std::move(flight.truth);
    result.true_subject = result.subject;
    result.true_changes = simulation.changes;
  } else {
    // A study may carry the flight that its recording was simulated from.
    if (root.has("flight")) static_cast<void>(read_simulation(root));
    progress.stage("reading the recording");
    log = recording::read_study_data(data);
    result.inputs = data.files(data.has("file") ? "file" : "files");
  }
  if (!result.reconstruct.estimate_file.empty()) result.inputs.push_back(result.reconstruct.estimate_file);
  result.mapped = map_channels(log, map, throws_of(result.subject, subject));
  if (data.has("calibration")) {
    const std::filesystem::path file = data.file("calibration");
    apply_calibration(read_calibration(file), result.mapped);
    result.inputs.push_back(file);
  }
  root.finish();
  return result;
}

FlightAnalysis reconstruct(const FlightStudy& study, Progress& progress) {
  return reconstruct_with(study, study.reconstruct, progress);
}

FlightAnalysis identify(const FlightStudy& study, Progress& progress) {
  FlightAnalysis analysis = analyse_motion(study, progress);
  if (analysis.interrupted) return analysis;
  if (analysis.reconstruction.contradiction) return without_motion(std::move(analysis), study, progress);
  const FlightSignals& signals = analysis.signals;
  const Segments& segments = analysis.segments;
  analysis.coefficients =
      identify_coefficients(signals, segments, study.subject, study.identify, progress, analysis.recording_evidence);
  analysis.others =
      compare_other_estimators(signals, segments, study.subject, analysis.coefficients, study.identify, progress);
  progress.stage("uncertainty of the measured coefficients");
  if (study.uncertainty.enabled) {
    analysis.uncertainty = coefficient_uncertainty(
        coefficient_inputs(signals, segments, study.subject, study.uncertainty, study.mapped.calibration_sigma),
        study.subject, study.uncertainty, study.seed, progress.threads());
  }
  progress.stage("validating on the hold-out");
  analysis.identified = identified_subject(study.subject, analysis.coefficients);
  analysis.validation =
      validate_flight(signals, segments.longitudinal.holdout, segments.lateral.holdout, analysis.identified,
                      identified_coefficients(analysis.coefficients), study.validate);
  return with_results(std::move(analysis), study, progress);
}

FlightAnalysis validate(const FlightStudy& study, const estimation::Estimate& estimate, Progress& progress) {
  FlightAnalysis analysis = analyse_motion(study, progress);
  if (analysis.interrupted) return analysis;
  if (analysis.reconstruction.contradiction) return without_motion(std::move(analysis), study, progress);
  const FlightSignals& signals = analysis.signals;
  const Segments& segments = analysis.segments;
  analysis.coefficients = evaluate_estimate(signals, segments, study.subject, study.identify, estimate);
  progress.stage("validating");
  analysis.identified = identified_subject(study.subject, analysis.coefficients);
  analysis.validation =
      validate_flight(signals, segments.longitudinal.excited, segments.lateral.excited, analysis.identified,
                      identified_coefficients(analysis.coefficients), study.validate);
  analysis = with_results(std::move(analysis), study, progress);
  // The parameters are those that were given; only the judgement is new.
  analysis.estimate.parameters = estimate.parameters;
  analysis.estimate.covariance = estimate.covariance;
  analysis.estimate.method = estimate.method;
  return analysis;
}

}  // namespace veridyn::aircraft
