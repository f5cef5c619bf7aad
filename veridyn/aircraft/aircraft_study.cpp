#include "veridyn/aircraft/aircraft_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

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
  const Channel& north = recording.at("vel_north");
  const Channel& east = recording.at("vel_east");
  for (std::size_t i = 0; i < std::min(north.size(), east.size()); ++i) {
    highest = std::fmax(highest, std::hypot(north.value[i], east.value[i]));
  }
  return {highest, "ground speed"};
}

/// What every analysis needs, refused in one sentence when it is missing.
void check_flight(const FlightStudy& study) {
  const std::vector<std::string> needed{"accel_x", "accel_y", "accel_z", "gyro_x",    "gyro_y",   "gyro_z",
                                        "roll",    "pitch",   "yaw",     "vel_north", "vel_east", "vel_down"};
  require_channels(study.mapped, needed, "the reconstruction of the motion through the air");
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

void align_and_reconstruct(FlightStudy& study, FlightAnalysis& analysis, Progress& progress) {
  check_flight(study);
  progress.stage("aligning sensor delays");
  analysis.delays = align_delays(study.mapped, study.delays, progress);
  analysis.interrupted = progress.interrupted();
  if (analysis.interrupted) return;
  const Subject& model = study.filter_subject ? *study.filter_subject : study.subject;
  analysis.reconstruction = reconstruct(study.mapped.recording, study.reconstruct, progress, &model);
  if (study.truth && study.reconstruct.compare && study.reconstruct.filter != FilterKind::kModelFree) {
    progress.stage("comparing the filters with the truth");
    analysis.reconstruction.comparison =
        compare_filters(study.mapped.recording, *study.truth, study.reconstruct, model, progress);
  }
  analysis.interrupted = analysis.reconstruction.interrupted;
}

void find_flight(FlightStudy& study, FlightAnalysis& analysis) {
  const bool data_sheet = study.reconstruct.sensors == "reference";
  analysis.signals = prepare_signals(study.mapped, analysis.reconstruction.smoothed, study.subject, study.signals,
                                     data_sheet ? &analysis.reconstruction.sigma : nullptr);
  const FlightSignals& s = analysis.signals;
  SegmentSignals signals;
  signals.begin = s.grid.begin;
  signals.step = s.grid.step;
  signals.airspeed = s[FlightSignal::kAirspeed].value;
  signals.p = s[FlightSignal::kP].value;
  signals.q = s[FlightSignal::kQ].value;
  signals.r = s[FlightSignal::kR].value;
  signals.elevator = s[FlightSignal::kElevator].value;
  signals.aileron = s[FlightSignal::kAileron].value;
  signals.rudder = s[FlightSignal::kRudder].value;
  analysis.segments = find_segments(signals, study.segments);
}

std::vector<std::string> names_with(std::span<const CoefficientResult> results, CoefficientVerdict verdict) {
  std::vector<std::string> names;
  for (const CoefficientResult& result : results) {
    if (result.verdict == verdict) names.push_back(result.name);
  }
  return names;
}

void summarise(const FlightStudy& study, FlightAnalysis& analysis) {
  estimation::Estimate& estimate = analysis.estimate;
  estimate = make_estimate(study.subject, analysis.coefficients);
  for (const OtherParameter& other : analysis.others.parameters) estimate.other_methods.push_back(other.estimate);
  std::vector<std::string> parts;
  for (const CoefficientVerdict verdict : {CoefficientVerdict::kIdentified, CoefficientVerdict::kRejected,
                                           CoefficientVerdict::kNotExcited, CoefficientVerdict::kSkipped}) {
    const std::vector<std::string> names = names_with(analysis.coefficients, verdict);
    if (!names.empty()) parts.push_back(fmt::format("{}: {}", to_string(verdict), fmt::join(names, ", ")));
  }
  estimate.verdict = fmt::format("{}", fmt::join(parts, "; "));
  for (const PredictedQuantity& q : analysis.validation.quantities) {
    estimate.validation[q.name] = {q.fit.mae, q.fit.rmse, q.fit.r2, q.fit.theil, q.unit};
  }
  const auto warn = [&](const std::vector<std::string>& texts) {
    estimate.warnings.insert(estimate.warnings.end(), texts.begin(), texts.end());
  };
  warn(study.subject.warnings);
  warn(study.mapped.recording.warnings);
  warn(study.mapped.notes);
  warn(analysis.reconstruction.warnings);
  warn(analysis.signals.notes);
  if (!study.subject.inertia) {
    estimate.warnings.emplace_back(
        "without subject.inertia the moments are identified per unit inertia (Cl/Jx, Cm/Jy, Cn/Jz), with the inertial "
        "coupling of a flat body (Jz = Jx + Jy, Jx = Jy, Jxz = 0) and the moments of the thrust left in");
  }
  for (const CoefficientResult& result : analysis.coefficients) {
    if (result.verdict != CoefficientVerdict::kIdentified) estimate.warnings.push_back(result.reason);
  }
}

/// The part that identification and validation share: from recording to signals and segments.
FlightAnalysis analyse_motion(FlightStudy& study, Progress& progress) {
  FlightAnalysis analysis;
  // The filter's estimate is only compared with the truth, where there is one; an hour of it takes 150 MB.
  study.reconstruct.keep_filter = study.truth.has_value();
  align_and_reconstruct(study, analysis, progress);
  if (!analysis.interrupted) find_flight(study, analysis);
  return analysis;
}

/// And the end that they share: the model of what may be used, flown over the spans, and the verdict.
void judge(const FlightStudy& study, FlightAnalysis& analysis, std::span<const TimeSpan> longitudinal,
           std::span<const TimeSpan> lateral, const Progress& progress) {
  analysis.identified = identified_subject(study.subject, analysis.coefficients);
  analysis.validation = validate_flight(analysis.signals, longitudinal, lateral, analysis.identified,
                                        identified_coefficients(analysis.coefficients), study.validate);
  summarise(study, analysis);
  analysis.interrupted = progress.interrupted();
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

FlightAnalysis reconstruct(FlightStudy& study, Progress& progress) {
  FlightAnalysis analysis;
  align_and_reconstruct(study, analysis, progress);
  return analysis;
}

FlightAnalysis identify(FlightStudy& study, Progress& progress) {
  FlightAnalysis analysis = analyse_motion(study, progress);
  if (analysis.interrupted) return analysis;
  analysis.coefficients =
      identify_coefficients(analysis.signals, analysis.segments, study.subject, study.identify, progress);
  analysis.others = estimate_otherwise(analysis.signals, analysis.segments, study.subject, analysis.coefficients,
                                       study.identify, progress);
  progress.stage("uncertainty of the measured coefficients");
  if (study.uncertainty.enabled) {
    analysis.uncertainty =
        coefficient_uncertainty(coefficient_inputs(analysis.signals, analysis.segments, study.subject,
                                                   study.uncertainty, study.mapped.calibration_sigma),
                                study.subject, study.uncertainty, study.seed);
  }
  progress.stage("validating on the hold-out");
  judge(study, analysis, analysis.segments.longitudinal.holdout, analysis.segments.lateral.holdout, progress);
  return analysis;
}

FlightAnalysis validate(FlightStudy& study, const estimation::Estimate& estimate, Progress& progress) {
  FlightAnalysis analysis = analyse_motion(study, progress);
  if (analysis.interrupted) return analysis;
  analysis.coefficients =
      evaluate_estimate(analysis.signals, analysis.segments, study.subject, study.identify, estimate);
  progress.stage("validating");
  judge(study, analysis, analysis.segments.longitudinal.excited, analysis.segments.lateral.excited, progress);
  // The parameters are those that were given; only the judgement is new.
  analysis.estimate.parameters = estimate.parameters;
  analysis.estimate.covariance = estimate.covariance;
  analysis.estimate.method = estimate.method;
  return analysis;
}

}  // namespace veridyn::aircraft
