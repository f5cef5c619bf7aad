#include "veridyn/aircraft/aircraft_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/export/flight_condition.hpp"
#include "veridyn/aircraft/flying_qualities/derived_modes.hpp"
#include "veridyn/aircraft/identification/evidence/contradicted_flight.hpp"
#include "veridyn/aircraft/identification/evidence/recording_evidence.hpp"
#include "veridyn/aircraft/identification/fit/accelerometer_place.hpp"
#include "veridyn/aircraft/identification/fit/flight_delays.hpp"
#include "veridyn/aircraft/identification/fit/gust_share.hpp"
#include "veridyn/aircraft/identification/identified_estimate.hpp"
#include "veridyn/aircraft/identification/parameter_groups.hpp"
#include "veridyn/aircraft/identification/rows/flight_set.hpp"
#include "veridyn/aircraft/identification/rows/typical_flight.hpp"
#include "veridyn/aircraft/identification/signals/direct_air_data.hpp"
#include "veridyn/aircraft/identification/signals/excited_segments.hpp"
#include "veridyn/aircraft/identification/validation/evaluated_estimate.hpp"
#include "veridyn/aircraft/reconstruction/filter_comparison.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"
#include "veridyn/aircraft/sensors/accelerometer_at_centre.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

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
    throw InputError(study.mapped.recording.source,
                     fmt::format("the aircraft never flies: the {} does not exceed {:.1f} m/s, {} needs {:.1f} m/s "
                                 "(key segments.min_airspeed)",
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
PreparedFlight reconstructed(const FlightStudy& study, const ReconstructOptions& options, Progress& progress) {
  check_flight(study);
  progress.stage("aligning sensor delays");
  MappedRecording at_centre = study.mapped;
  at_centre.recording = with_accelerometer_at_centre(std::move(at_centre.recording), study.subject.imu_position);
  AlignedRecording aligned = align_delays(
      std::move(at_centre), internal::alignment_of(study.mapped.recording, study.delays, study.reconstruct), progress);
  PreparedFlight flight;
  flight.aligned = std::move(aligned.mapped);
  // Signals and filters move it by smoother angular accelerations.
  for (const char* name : {"accel_x", "accel_y", "accel_z"})
    if (const Channel* recorded = study.mapped.recording.find(name)) flight.aligned.recording.set(*recorded);
  flight.delays = std::move(aligned.delays);
  flight.reconstruction.interrupted = progress.interrupted();
  if (flight.reconstruction.interrupted) return flight;
  const Recording& recording = flight.aligned.recording;
  const Subject& model = study.filter_subject ? *study.filter_subject : study.subject;
  flight.reconstruction = motion_of(recording, options, study.signals, progress, model);
  const bool by_model = options.filter == FilterKind::kModelBased || options.filter == FilterKind::kGuarded;
  if (study.truth && options.compare && by_model) {
    progress.stage("comparing the filters with the truth");
    flight.reconstruction.comparison = compare_filters(recording, *study.truth, options, model, progress);
  }
  return flight;
}

/// From a recording to signals and segments.
PreparedFlight prepared(const FlightStudy& study, Progress& progress) {
  ReconstructOptions options = study.reconstruct;
  // The filter's estimate is only compared with the truth, where there is one; an hour of it takes 150 MB.
  options.keep_filter = study.truth.has_value();
  PreparedFlight flight = reconstructed(study, options, progress);
  flight.name = study.run;
  if (flight.reconstruction.interrupted) return flight;
  if (flight.usable()) {
    const bool data_sheet = options.sensors == NoiseSource::kReference;
    const auto prepare = [&] {
      flight.signals = prepare_signals(
          flight.aligned, flight.reconstruction.smoothed, flow_sensors(options, flight.reconstruction.smoothed),
          study.subject, study.signals, data_sheet ? &flight.reconstruction.sigma : nullptr, progress.threads());
    };
    prepare();
    flight.segments = excited_segments(flight.signals, study.segments);
    align_by_manoeuvres(flight, study.subject, study.delays, study.known_sensors);
    prepare();
    leave_out_slow_flight(flight.signals, flight.segments, study.segments.min_airspeed_mps);
    if (study.held_out) flight.segments = all_held_out(std::move(flight.segments));
  } else {
    flight.segments = recorded_flight(flight.aligned.recording, study.segments.min_airspeed_mps);
  }
  progress.stage("checking the recording");
  CheckedFlight checked =
      recording_evidence(flight.aligned.recording, flight.reconstruction, options, flight.segments, flight.delays,
                         progress.threads(), study.known_sensors, study.subject.imu_position);
  flight.recording_evidence = std::move(checked.rows);
  if (flight.usable()) {
    flight.budget.add(checked.errors);
    for (std::string& note : lag_notes(flight.budget)) flight.signals.notes.push_back(std::move(note));
    flight.signals = without_errors(std::move(flight.signals), flight.budget.errors);
    know_gusts_across(flight, study.subject);
    for (const auto& further : {accelerometer_place, air_errors}) {
      const std::vector<SensorError> errors = further(flight, study.subject, study.known_sensors);
      flight.budget.add(errors);
      flight.signals = without_errors(std::move(flight.signals), errors);
    }
  }
  return flight;
}

/// Every flight made ready by itself.
FlightAnalysis prepared(std::span<const FlightStudy> studies, Progress& progress) {
  FlightAnalysis analysis;
  for (const FlightStudy& study : studies) {
    analysis.flights.push_back(prepared(study, progress));
    analysis.interrupted = analysis.flights.back().reconstruction.interrupted;
    if (analysis.interrupted) return analysis;
  }
  if (studies.size() > 1) analysis.flights = side_by_side(std::move(analysis.flights));
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

std::vector<std::string> warnings_of(std::span<const FlightStudy> studies, const FlightAnalysis& analysis) {
  const Subject& subject = studies.front().subject;
  std::vector<std::string> warnings = subject.warnings;
  for (std::size_t i = 0; i < studies.size(); ++i) {
    const PreparedFlight& flight = analysis.flights[i];
    const MappedRecording& mapped = studies[i].mapped;
    for (const auto* texts :
         {&mapped.recording.warnings, &mapped.notes, &flight.reconstruction.warnings, &flight.signals.notes}) {
      for (const std::string& text : *texts) warnings.push_back(of_flight(flight.name, text));
    }
  }
  if (!subject.inertia) {
    warnings.emplace_back(
        "without subject.inertia the moments are identified per unit inertia (Cl/Jx, Cm/Jy, Cn/Jz), with the inertial "
        "coupling of a flat body (Jz = Jx + Jy, Jx = Jy, Jxz = 0) and the moments of the thrust left in");
  }
  for (const CoefficientResult& result : analysis.coefficients) {
    if (!estimation::usable(result.verdict) && result.verdict != estimation::GroupVerdict::kRejected)
      warnings.push_back(result.reason);
  }
  return warnings;
}

/// Flown open loop over held-out data, the model must be nearer than the mean of what was flown.
std::vector<estimation::Evidence> flown_evidence(const Validation& validation) {
  using namespace estimation;
  std::vector<Evidence> rows;
  for (const PredictedQuantity& q : validation.quantities) {
    // Gusts, which the model is not given, can cost a good one its lead over the mean; they do not make it miss by
    // three times what the motion varies.
    rows.push_back(row_of(Check::kFlownOverHoldOut, q.name, q.fit.r2)
                       .with("period", validation.period_s)
                       .with("error", q.fit.mae)
                       .with("unit", q.unit));
    rows.push_back(row_of(Check::kFlownAgainstLast, q.name, q.fit.rmse / q.last_value_rmse));
  }
  return rows;
}

/// The checks of all recordings.
std::vector<estimation::Evidence> recording_rows(std::span<const PreparedFlight> flights) {
  std::vector<estimation::Evidence> rows;
  for (const PreparedFlight& flight : flights)
    rows.insert(rows.end(), flight.recording_evidence.begin(), flight.recording_evidence.end());
  return rows;
}

/// The grades of the coefficients together, and of what bears on all of them.
estimation::Judgement judgement_of(const FlightAnalysis& analysis, std::span<const estimation::Evidence> of_all) {
  std::vector<estimation::Judgement> parts;
  for (const CoefficientResult& result : analysis.coefficients) parts.push_back(result.judgement);
  const estimation::Judgement coefficients = estimation::judge_together(parts);
  // What none of them rests on spoils nothing.
  std::vector<estimation::Evidence> rested_on(of_all.begin(), of_all.end());
  std::erase_if(rested_on, [&](const estimation::Evidence& row) {
    return std::ranges::none_of(analysis.coefficients,
                                [&](const CoefficientResult& result) { return affects(row, result.coefficient); });
  });
  const estimation::Judgement whole = estimation::judge(rested_on);
  estimation::Judgement judgement = coefficients;
  judgement.data = whole.data;
  judgement.prediction = estimation::worse(coefficients.prediction, whole.prediction);
  return judgement;
}

estimation::ValidationMeasure measure_of(const numerics::FitMeasures& fit, const std::string& unit) {
  return {fit.mae, fit.rmse, fit.r2, fit.theil, unit};
}

/// What each of several recordings was for, and how well it is predicted.
std::vector<estimation::RecordingUse> recordings_of(const FlightAnalysis& analysis, bool tried) {
  std::vector<estimation::RecordingUse> recordings = recording_uses(analysis.flights, tried);
  for (estimation::RecordingUse& recording : recordings) {
    for (const CoefficientResult& result : analysis.coefficients) {
      for (const FlightFit& f : result.flight_fits)
        if (f.flight == recording.name) recording.validation[result.name] = measure_of(f.fit, "1");
    }
    for (const FlightPrediction& flown : analysis.validation.by_flight) {
      if (flown.flight != recording.name) continue;
      for (const PredictedQuantity& q : flown.quantities) recording.validation[q.name] = measure_of(q.fit, q.unit);
    }
    for (const estimation::OpenLoopRecording& flown : analysis.open_loop.by_recording) {
      if (flown.recording != recording.name) continue;
      for (const estimation::OpenLoopState& state : flown.states)
        recording.validation[estimation::open_loop_name(state)] = measure_of(state.fit, state.unit);
    }
  }
  return recordings;
}

/// The parameters with their covariance.
estimation::Estimate estimate_of(const FlightStudy& study, const FlightAnalysis& analysis) {
  return make_estimate(study.subject, analysis.coefficients, analysis.others.output_error);
}

/// That nothing was identified, where that is so.
std::vector<estimation::Evidence> nothing_identified(std::span<const CoefficientResult> coefficients) {
  const bool predicts = std::ranges::any_of(coefficients, [](const CoefficientResult& result) {
    return result.verdict == estimation::GroupVerdict::kIdentified ||
           result.verdict == estimation::GroupVerdict::kEffective;
  });
  if (predicts) return {};
  estimation::Evidence row =
      estimation::row_of(estimation::Check::kIdentifiedCoefficients, "", estimation::Outcome::kMissing);
  row.value = 0.0;
  row.limit = 1.0;
  row.cause = estimation::Cause::kExcitation;
  return {std::move(row)};
}

/// What estimate.json will say of an analysis that is complete but for it.
estimation::Estimate summarise(std::span<const FlightStudy> studies, const FlightAnalysis& analysis) {
  estimation::Estimate estimate = estimate_of(studies.front(), analysis);
  for (const OtherParameter& other : analysis.others.parameters) estimate.other_methods.push_back(other.estimate);
  add_flight_condition(analysis.flights, estimate);
  estimate.verdict = verdict_text(analysis.coefficients);
  for (const PredictedQuantity& q : analysis.validation.quantities) {
    estimate.validation[q.name] = measure_of(q.fit, q.unit);
  }
  estimation::add_open_loop(analysis.open_loop, estimate);
  estimate.warnings = warnings_of(studies, analysis);
  std::vector<estimation::Evidence> of_all = recording_rows(analysis.flights);
  for (const std::vector<estimation::Evidence>& rows :
       {flown_evidence(analysis.validation), open_loop_evidence(analysis.open_loop),
        nothing_identified(analysis.coefficients)})
    of_all.insert(of_all.end(), rows.begin(), rows.end());
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
FlightAnalysis with_results(FlightAnalysis analysis, std::span<const FlightStudy> studies, const Progress& progress) {
  const FlightStudy& study = studies.front();
  analysis.estimate = summarise(studies, analysis);
  analysis.estimate.recordings = recordings_of(analysis, false);
  analysis.groups = parameter_groups(analysis.coefficients, analysis.others);
  analysis.predictions = predictions(analysis.validation.quantities, analysis.coefficients);
  if (study.true_subject) analysis.truth = true_values(*study.true_subject, study.subject, analysis.coefficients);
  analysis.interrupted = progress.interrupted();
  return analysis;
}

/// What is left to say where the motion of no flight could be reconstructed: the rows of the recordings.
FlightAnalysis without_motion(FlightAnalysis analysis, std::span<const FlightStudy> studies, const Progress& progress) {
  const FlightStudy& study = studies.front();
  const PreparedFlight& flight = analysis.flights.front();
  analysis.coefficients =
      not_identified(study.subject, study.identify, *flight.reconstruction.contradiction, flight.recording_evidence);
  analysis.identified = identified_subject(study.subject, analysis.coefficients);
  return with_results(std::move(analysis), studies, progress);
}

/// The identified model from deflections and thrust alone, where the study asks for it.
OpenLoop open_loop_of(const FlightAnalysis& analysis, RowUse use, const FlightStudy& study,
                      const estimation::Estimate& estimate, Progress& progress) {
  const OpenLoopOptions& options = study.validate.open_loop;
  if (options.asked()) progress.stage("flying open loop");
  return fly_open_loop(analysis.flights, use, analysis.identified, identified_coefficients(analysis.coefficients),
                       estimate, options, progress);
}

/// The natural modes of the identified aircraft in the straight flight nearest to what was flown.
std::vector<estimation::DerivedQuantity> modes_of(const FlightAnalysis& analysis, const FlightStudy& study) {
  const std::optional<Trim> flown = typical_flight(analysis.flights, study.flying_qualities.airspeed);
  if (!flown) return {};
  return derived_modes(analysis.identified, analysis.coefficients, analysis.estimate, *flown, study.flying_qualities,
                       study.seed);
}

/// Whether the motion of any flight is known.
bool any_motion(const FlightAnalysis& analysis) {
  return std::ranges::any_of(analysis.flights, &PreparedFlight::usable);
}

}  // namespace

FlightAnalysis reconstruct(const FlightStudy& study, Progress& progress) {
  FlightAnalysis analysis;
  analysis.flights.push_back(reconstructed(study, study.reconstruct, progress));
  analysis.interrupted = analysis.flights.front().reconstruction.interrupted;
  return analysis;
}

FlightAnalysis identify(std::span<const FlightStudy> studies, Progress& progress) {
  const FlightStudy& study = studies.front();
  FlightAnalysis analysis = prepared(studies, progress);
  if (analysis.interrupted) return analysis;
  if (!any_motion(analysis)) return without_motion(std::move(analysis), studies, progress);
  Identification found = identify_coefficients(analysis.flights, study.subject, study.identify, progress);
  analysis.others = compare_other_estimators(analysis.flights, study.subject, found, study.identify, progress);
  analysis.coefficients = std::move(found.coefficients);
  progress.stage("uncertainty of the measured coefficients");
  if (study.uncertainty.enabled) {
    analysis.uncertainty = coefficient_uncertainty(
        coefficient_inputs(analysis.flights, study.subject, study.uncertainty, study.mapped.calibration_sigma),
        study.subject, study.uncertainty, study.seed, progress.threads());
  }
  progress.stage("validating on the hold-out");
  analysis.identified = identified_subject(study.subject, analysis.coefficients);
  analysis.validation = validate_flights(analysis.flights, RowUse::kHoldout, analysis.identified,
                                         identified_coefficients(analysis.coefficients), study.validate);
  analysis.open_loop = open_loop_of(analysis, RowUse::kHoldout, study, estimate_of(study, analysis), progress);
  analysis = with_results(std::move(analysis), studies, progress);
  progress.stage("modes and flying qualities");
  analysis.estimate.derived = modes_of(analysis, study);
  return analysis;
}

FlightAnalysis identify(const FlightStudy& study, Progress& progress) {
  return identify(std::span<const FlightStudy>(&study, 1), progress);
}

FlightAnalysis validate(std::span<const FlightStudy> studies, const estimation::Estimate& estimate,
                        Progress& progress) {
  const FlightStudy& study = studies.front();
  FlightAnalysis analysis = prepared(studies, progress);
  if (analysis.interrupted) return analysis;
  if (!any_motion(analysis)) return without_motion(std::move(analysis), studies, progress);
  analysis.coefficients = evaluate_estimate(analysis.flights, study.subject, study.identify, estimate);
  progress.stage("validating");
  analysis.identified = identified_subject(study.subject, analysis.coefficients);
  analysis.validation = validate_flights(analysis.flights, RowUse::kExcited, analysis.identified,
                                         identified_coefficients(analysis.coefficients), study.validate);
  analysis.open_loop = open_loop_of(analysis, RowUse::kExcited, study, estimate, progress);
  analysis = with_results(std::move(analysis), studies, progress);
  // The parameters are those that were given; only the judgement is new.
  analysis.estimate.parameters = estimate.parameters;
  analysis.estimate.covariance = estimate.covariance;
  analysis.estimate.method = estimate.method;
  analysis.estimate.derived = estimate.derived;
  analysis.estimate.recordings = recordings_of(analysis, true);
  return analysis;
}

FlightAnalysis validate(const FlightStudy& study, const estimation::Estimate& estimate, Progress& progress) {
  return validate(std::span<const FlightStudy>(&study, 1), estimate, progress);
}

}  // namespace veridyn::aircraft
