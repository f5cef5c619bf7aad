#include "veridyn/vehicle/scale_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/at_place.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/vehicle/similarity/scaled_drive.hpp"
#include "veridyn/vehicle/simulation/trajectory_table.hpp"

namespace veridyn::vehicle {
namespace {

SimilaritySubject subject_of(const Vehicle& vehicle, double speed, double gravity) {
  SimilaritySubject s;
  s.parameters = vehicle.parameters;
  // Stiffnesses of load-dependent tyres are those at the static load.
  const auto [C_f, C_r] = cornering_stiffnesses(vehicle, gravity);
  s.parameters.C_f = C_f;
  s.parameters.C_r = C_r;
  s.speed = speed;
  s.gravity = gravity;
  return s;
}

MotionDifference difference(const std::string& name, const std::string& unit, const std::vector<double>& a,
                            const std::vector<double>& b) {
  MotionDifference d{name, unit};
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    d.largest = std::max(d.largest, std::abs(a[k] - b[k]));
    d.range = std::max(d.range, std::abs(a[k]));
  }
  return d;
}

}  // namespace

ScaleStudy read_scale_study(const StudyTable& root, const Progress& progress) {
  ScaleStudy study;
  study.simulation = read_simulation_study(root, progress);
  const double gravity = study.simulation.four_wheel.gravity;
  study.prototype = subject_of(study.simulation.vehicle, study.simulation.simulation.speed, gravity);
  if (study.simulation.manoeuvre.amplitude != 0.0) study.prototype.steer = study.simulation.manoeuvre.amplitude;
  const StudyTable scale = root.table("scale");
  study.prototype.further = read_similarity_parameters(scale);
  study.request = ScaleRequest::keys().read(scale);
  study.repeating = scale.has("repeating") ? scale.texts("repeating")
                                           : std::vector<std::string>(default_repeating_variables().begin(),
                                                                      default_repeating_variables().end());
  at_place(scale.place("repeating"), [&] { static_cast<void>(similarity_groups(study.prototype, study.repeating)); });
  study.requested = study.request.length_ratio || study.request.mass || study.request.speed;
  if (!scale.has("model")) {
    if (!study.requested)
      scale.fail("length_ratio",
                 "is missing: [scale] needs a length_ratio, mass or speed, or a [scale.model] to check");
    return study;
  }
  const StudyTable table = scale.table("model");
  study.given = read_vehicle(table, VehicleNeeds::kFourWheel);
  double speed = study.given->speed.value_or(study.request.speed.value_or(0.0));
  if (table.has("speed") || speed == 0.0) speed = table.positive("speed", "m/s");
  study.given_subject = subject_of(*study.given, speed, gravity);
  study.given_subject.steer = study.prototype.steer;
  const ScaleFactors factors = scale_factors(study.prototype, study.given_subject);
  study.given_subject.further = study.prototype.further;
  for (const StudyTable& row : scale.tables("parameter")) {
    for (SimilarityParameter& p : study.given_subject.further) {
      if (p.name == row.text("name")) p.value = row.number_or("model", p.unit.si_name(), p.value * factors.of(p.unit));
    }
  }
  if (!study.requested) {
    study.request.length_ratio = factors.length;
    study.request.mass = study.given_subject.parameters.mass;
    study.request.speed = speed;
  }
  return study;
}

VehicleTrajectory simulate_scaled(const SimulationStudy& study, const Vehicle& vehicle, const ScaleFactors& factors,
                                  double gravity, Progress& progress) {
  SimulationOptions simulation = study.simulation;
  simulation.duration *= factors.time();
  simulation.step *= factors.time();
  simulation.output_step *= factors.time();
  simulation.speed *= factors.speed;
  FourWheelOptions options = study.four_wheel;
  options.gravity = gravity;
  options.relaxation_length = vehicle.relaxation_length;
  options.suspension_f = vehicle.suspension_f;
  options.suspension_r = vehicle.suspension_r;
  options.lift = vehicle.lift;
  if (options.longitudinal) options.longitudinal = vehicle.longitudinal;
  ScaledDriver driver(*study.manoeuvre.driver, factors);
  std::optional<ScaledRoad> road;
  if (study.road) road.emplace(*study.road, factors.length);
  return simulate(vehicle, study.model, options, driver, road ? &*road : nullptr, simulation, progress);
}

std::vector<MotionDifference> motion_differences(const VehicleTrajectory& prototype,
                                                 const VehicleTrajectory& rescaled) {
  std::vector<MotionDifference> list;
  MotionDifference path{"path", "m"};
  for (std::size_t k = 0; k < std::min(prototype.size(), rescaled.size()); ++k) {
    path.largest = std::max(path.largest, std::hypot(prototype.x[k] - rescaled.x[k], prototype.y[k] - rescaled.y[k]));
    path.range = std::max(path.range, std::hypot(prototype.x[k], prototype.y[k]));
  }
  list.push_back(path);
  for (const TrajectoryQuantity& q : trajectory_quantities()) {
    const auto& a = prototype.*q.values;
    const std::string name = q.name;
    if (!a.empty() && name != "x" && name != "y") list.push_back(difference(q.name, q.unit, a, rescaled.*q.values));
  }
  for (const WheelQuantity& q : wheel_quantities()) {
    MotionDifference worst{q.name, q.unit};
    for (std::size_t i = 0; i < kWheels; ++i) {
      const MotionDifference d = difference(q.name, q.unit, (prototype.*q.values)[i], (rescaled.*q.values)[i]);
      worst.largest = std::max(worst.largest, d.largest);
      worst.range = std::max(worst.range, d.range);
    }
    if (worst.range > 0.0) list.push_back(worst);
  }
  return list;
}

const SimilarityReport& ScaleAnalysis::judged() const { return given_report ? *given_report : twin_report; }

std::vector<std::string> ScaleAnalysis::ended_early() const {
  std::vector<std::string> texts;
  if (prototype.end != DriveEnd::kCompleted) texts.push_back("prototype: " + prototype.message());
  for (const ScaledRun& run : runs) {
    if (run.trajectory.end != DriveEnd::kCompleted) texts.push_back(run.name + ": " + run.trajectory.message());
  }
  return texts;
}

ScaleAnalysis run_scale_study(const ScaleStudy& study, Progress& progress) {
  ScaleAnalysis analysis;
  analysis.scaled = scale(study.prototype, study.request);
  const ScaleFactors& factors = analysis.scaled.factors;
  analysis.twin = scaled(study.simulation.vehicle, factors);
  analysis.twin.name += ", scaled";
  analysis.twin_report = compare(study.prototype, analysis.scaled.model, study.repeating);
  if (study.given) analysis.given_report = compare(study.prototype, study.given_subject, study.repeating);

  const double gravity = study.simulation.four_wheel.gravity;
  analysis.prototype = simulate_scaled(study.simulation, study.simulation.vehicle, {}, gravity, progress);
  const auto add = [&](const std::string& name, const Vehicle& vehicle, const ScaleFactors& f, double g) {
    if (analysis.prototype.end == DriveEnd::kInterrupted) return;
    ScaledRun run;
    run.name = name;
    run.trajectory = simulate_scaled(study.simulation, vehicle, f, g, progress);
    run.rescaled = scaled(run.trajectory, f.inverse());
    run.differences = motion_differences(analysis.prototype, run.rescaled);
    analysis.interrupted = analysis.interrupted || run.trajectory.end == DriveEnd::kInterrupted;
    analysis.runs.push_back(std::move(run));
  };
  analysis.interrupted = analysis.prototype.end == DriveEnd::kInterrupted;
  const bool other_gravity = std::abs(analysis.scaled.similar_gravity / gravity - 1.0) > 1e-9;
  if (other_gravity) {
    add(fmt::format("exact twin, gravity {:.4g} m/s^2", analysis.scaled.similar_gravity), analysis.twin, factors,
        analysis.scaled.similar_gravity);
  }
  add("exact twin", analysis.twin, factors, gravity);
  if (study.given) add(study.given->name, *study.given, scale_factors(study.prototype, study.given_subject), gravity);
  return analysis;
}

}  // namespace veridyn::vehicle
