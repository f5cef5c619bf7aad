#include "veridyn/vehicle/vehicle_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"
#include "veridyn/vehicle/identification/fit/estimated_drive_model.hpp"
#include "veridyn/vehicle/identification/validation/vehicle_prediction.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Check;
using estimation::Outcome;
using estimation::row_of;

/// Cornering stiffness over static load of common tyres [1/rad].
constexpr double kStiffnessPerLoad = 20.0;
/// Height of the centre of gravity of common cars over their wheelbase.
constexpr double kHeightPerWheelbase = 0.21;

VehicleStudy read_tables(const Study& study) {
  const StudyTable& root = study.root();
  VehicleStudy out;
  out.name = root.text_or("title", study.name());
  out.seed = static_cast<std::uint64_t>(root.integer_or("seed", 1));
  const StudyTable subject = root.table("subject");
  const Vehicle vehicle = read_vehicle(subject, VehicleNeeds::kGeometry);
  out.subject_name = vehicle.name.empty() ? "vehicle" : vehicle.name;
  out.vehicle = vehicle.parameters;
  out.inputs = vehicle.inputs;
  out.signals = DriveSignalOptions::keys().read(root.table_or_empty("signals"));
  VehicleParameters<double>& p = out.vehicle;
  const bool known = subject.has("builtin");
  if (!known && !subject.has("I_z")) p.I_z = p.mass * p.a * p.b;
  const PerWheel<double> load = static_loads(p, out.signals.gravity);
  if (!known && !subject.has("C_f")) p.C_f = kStiffnessPerLoad * load[kFrontLeft];
  if (!known && !subject.has("C_r")) p.C_r = kStiffnessPerLoad * load[kRearLeft];
  out.segments = DriveSegmentOptions::keys().read(root.table_or_empty("segments"));
  out.identify = VehicleIdentifyOptions::keys().read(root.table_or_empty("identify"));
  if (!known && !subject.has("cg_height")) p.cg_height = kHeightPerWheelbase * p.wheelbase();
  out.identify.model.gravity = out.signals.gravity;
  out.track = DriveTrackOptions::keys().read(root.table_or_empty("track"));
  out.validation = DriveValidateOptions::keys().read(root.table_or_empty("validate"));
  return out;
}

std::vector<std::string> warnings_of(const VehicleStudy& study, const DriveSignals& signals) {
  std::vector<std::string> warnings = study.log.mapped.recording.warnings;
  const auto add = [&](const std::vector<std::string>& more) {
    warnings.insert(warnings.end(), more.begin(), more.end());
  };
  add(study.log.mapped.notes);
  add(signals.notes);
  add(study.notes);
  return warnings;
}

/// @throws InputError where it has not what a prediction needs.
EstimatedDriveModel model_of(const estimation::Estimate& estimate, const VehicleStudy& study) {
  EstimatedDriveModel given = estimated_drive_model(estimate, study.vehicle, study.identify.model);
  if (!given.missing.empty()) {
    throw InputError("estimate",
                     fmt::format("has no {}; without it no drive can be predicted", fmt::join(given.missing, ", ")));
  }
  return given;
}

VehicleEstimate given_estimate(const estimation::Estimate& estimate) {
  VehicleEstimate given{.method = vehicle_method(estimate.method), .usable = true};
  given.parameters = estimate.parameters;
  given.covariance = estimate.covariance;
  return given;
}

/// Where an estimate is validated, by time.
std::vector<TimeSpan> validation_spans(const DriveSegments& segments, bool holdout_only) {
  std::vector<TimeSpan> spans = segments.holdout;
  if (holdout_only) return spans;
  spans.insert(spans.end(), segments.identification.begin(), segments.identification.end());
  std::sort(spans.begin(), spans.end(), [](const TimeSpan& x, const TimeSpan& y) { return x.begin < y.begin; });
  return spans;
}

/// The estimate driven open loop, where the study asks for it; the rows are what that says of the prediction.
std::vector<estimation::Evidence> driven_open_loop(VehicleAnalysis& analysis, OpenLoopUse use,
                                                   const estimation::Estimate& estimate, const VehicleStudy& study,
                                                   Progress& progress) {
  if (!study.validation.open_loop.asked() || progress.interrupted()) return {};
  progress.stage("driving open loop");
  analysis.open_loop =
      drive_open_loop({analysis.signals, analysis.segments, use, study.vehicle, study.identify.model, estimate},
                      study.validation.open_loop, progress);
  return open_loop_evidence(analysis.open_loop);
}

/// What was identified, without the error of mass and geometry, which a model that keeps these does not have.
estimation::Estimate by_motion(const VehicleIdentification& identification, const std::string& subject) {
  estimation::Estimate estimate = make_vehicle_estimate(identification, subject);
  const VehicleEstimate* const best = identification.best();
  if (best != nullptr && best->given_covariance.size() > 0) estimate.covariance -= best->given_covariance;
  return estimate;
}

/// `yaw_rate` is null where this drive could not be predicted.
estimation::Evidence another_drive(const estimation::PredictedQuantity* yaw_rate, double least_r2) {
  const Outcome outcome =
      yaw_rate == nullptr ? Outcome::kFailed : estimation::outcome_of_hold_out(yaw_rate->fit.r2, least_r2);
  estimation::Evidence row = row_of(Check::kAnotherRecording, "yaw_rate", outcome);
  row.limit = outcome == Outcome::kCare ? estimation::kHoldOutCare : least_r2;
  if (yaw_rate == nullptr)
    row.cause = estimation::Cause::kMissing;
  else
    row.value = yaw_rate->fit.r2;
  return row;
}

/// The results in the terms that all domains share.
VehicleAnalysis with_results(VehicleAnalysis analysis, const VehicleStudy& study) {
  analysis.estimate = make_vehicle_estimate(analysis.identification, study.subject_name);
  estimation::add_open_loop(analysis.open_loop, analysis.estimate);
  add_path(analysis.open_loop.path, analysis.estimate);
  analysis.groups = {parameter_group(analysis.identification, study.subject_name)};
  analysis.predictions = analysis.identification.validation.quantities;
  analysis.truth = study.truth;
  return analysis;
}

}  // namespace

VehicleStudy read_study(const Study& study, Progress& progress) {
  VehicleStudy out = read_tables(study);
  const StudyTable& root = study.root();
  if (!root.has("data")) root.fail("data", "is missing: the study names no recording of a drive");
  progress.stage("reading the recording");
  out.log = read_drive_log(root.table("data"));
  out.inputs.insert(out.inputs.end(), out.log.inputs.begin(), out.log.inputs.end());
  return out;
}

VehicleStudy read_study(const Study& study, const Recording& recording, Progress& /*progress*/) {
  VehicleStudy out = read_tables(study);
  const StudyTable data = study.root().table_or_empty("data");
  out.log.mapped = map_drive_channels(recording, data.table_or_empty("map"), data.text_or("frame", ""),
                                      data.has("frame") ? data.place("frame") : std::string());
  out.log.runs = {recording.span()};
  return out;
}

VehicleAnalysis identify(const VehicleStudy& study, Progress& progress) {
  VehicleAnalysis out;
  out.signals = prepare_drive_signals(study.log.mapped, study.signals);
  out.segments = find_drive_segments(out.signals, study.segments, study.log.holdout_runs);
  const DriveFindings recording =
      drive_findings(study.log.mapped, out.signals, out.segments, study.vehicle, study.signals, progress);
  VehicleIdentifyOptions options = study.identify;
  options.model = with_course(std::move(options.model), out.signals.lateral_by_course);
  out.identification = identify_parameters(
      {out.signals, out.segments, study.vehicle, study.signals, options, &recording}, progress,
      [&](const VehicleIdentification& found) {
        return driven_open_loop(out, OpenLoopUse::kHoldout, by_motion(found, study.subject_name), study, progress);
      });
  out.interrupted = out.identification.interrupted;
  std::vector<std::string> warnings = warnings_of(study, out.signals);
  if (!out.signals.gravity_removed && out.signals[DriveSignal::kAccelY].available() &&
      !study.identify.model.free[DriveUnknown::kAccelYScale] && !has_roll(out.identification.structure)) {
    warnings.emplace_back(
        "accel_y is taken as it is: where the sensor leans with the body it shows g sin(roll) too (5 deg of roll per g "
        "make 8.7 % of it); give signals.roll_gradient, record roll, or estimate accel_y_scale");
  }
  warnings.insert(warnings.end(), out.identification.warnings.begin(), out.identification.warnings.end());
  out.identification.warnings = std::move(warnings);
  return with_results(std::move(out), study);
}

VehicleAnalysis validate(const VehicleStudy& study, const estimation::Estimate& estimate, Progress& progress) {
  VehicleAnalysis out;
  out.signals = prepare_drive_signals(study.log.mapped, study.signals);
  out.segments = find_drive_segments(out.signals, study.segments, study.log.holdout_runs);
  progress.stage("validating");
  const std::vector<TimeSpan> spans = validation_spans(out.segments, study.validation.holdout_only);
  const EstimatedDriveModel given = model_of(estimate, study);
  VehicleIdentification& id = out.identification;
  id.identified = given.vehicle;
  id.estimates.push_back(given_estimate(estimate));
  id.chosen = id.estimates.back().method;
  if (spans.empty()) {
    id.verdict = estimation::GroupVerdict::kNotExcited;
    id.reason = fmt::format("the estimate cannot be judged: {}", out.segments.text);
  } else {
    const DriveTheta theta{fit_drive_biases(out.signals, spans, given.vehicle, given.options, progress),
                           given.covariance};
    id.validation = predict_drive(out.signals, spans, given.vehicle, given.options, theta, progress);
    id.checks = {another_drive(id.validation.find("yaw_rate"), study.identify.min_holdout_r2)};
    // A vehicle is rejected as a whole; what was not excited, or given, keeps that status.
    if (std::ranges::any_of(estimate.parameters, [](const estimation::Parameter& p) {
          return p.status == estimation::ParameterStatus::kRejected && is_one_of(p.name, kBasicUnknowns);
        }))
      id.checks.insert(id.checks.begin(), row_of(Check::kRejectedBefore, "", Outcome::kFailed));
    KnownByModel known;
    if (const estimation::Parameter* p = estimate.find(kDriveUnknownNames[DriveUnknown::kRollGradient]))
      known.roll_gradient = p->value;
    const auto add = [&](std::vector<estimation::Evidence> rows) {
      std::ranges::move(rows, std::back_inserter(id.checks));
    };
    add(recording_rows(
        drive_findings(study.log.mapped, out.signals, out.segments, given.vehicle, study.signals, progress), known));
    add(driven_open_loop(out, study.validation.holdout_only ? OpenLoopUse::kOtherHoldout : OpenLoopUse::kOtherDrive,
                         estimate, study, progress));
    id.judgement = estimation::judge(id.checks);
    // Nothing was identified.
    id.judgement.parameters = {};
    const estimation::PurposeGrade& predicts = id.judgement.prediction;
    const bool holds = predicts.grade == estimation::Grade::kYes || predicts.grade == estimation::Grade::kWithCare;
    id.verdict = holds ? estimation::GroupVerdict::kIdentified : estimation::GroupVerdict::kRejected;
    id.reason = holds ? "holds: " + says(id.checks.front()) : "does not hold: " + predicts.decided_by.front();
  }
  id.warnings = warnings_of(study, out.signals);
  id.warnings.emplace_back("constant biases of steering, yaw rate and accel_y were fitted to this drive");
  out.interrupted = progress.interrupted();
  out = with_results(std::move(out), study);
  out.estimate.parameters = estimate.parameters;
  out.estimate.covariance = estimate.covariance;
  out.estimate.method = estimate.method;
  out.estimate.interrupted = estimate.interrupted;
  out.estimate.structure = name_of(given.options.structure, given.options.effects);
  out.estimate.structure_reason = fmt::format("structure: {}, as the estimate has it", out.estimate.structure);
  return out;
}

}  // namespace veridyn::vehicle
