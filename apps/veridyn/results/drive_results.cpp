// What the commands on a vehicle's drive share: preparing the drive, writing and printing its analysis.
#include "apps/veridyn/results/drive_results.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>

#include "apps/veridyn/results/analysis_results.hpp"
#include "apps/veridyn/results/open_loop_results.hpp"
#include "apps/veridyn/results/profile_results.hpp"
#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/judgement/subject_grades.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/drive_report.hpp"
#include "veridyn/vehicle/identification/fit/estimated_vehicle.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_profiles.hpp"
#include "veridyn/vehicle/simulation/trajectory_table.hpp"
#include "veridyn/vehicle/simulation_study.hpp"
#include "veridyn/vehicle/track_drive.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::vehicle;

std::map<std::string, double, std::less<>> truth_of(const Vehicle& vehicle, double gravity) {
  VehicleParameters<double> p = vehicle.parameters;
  const auto [C_f, C_r] = cornering_stiffnesses(vehicle, gravity);
  p.C_f = C_f;
  p.C_r = C_r;
  std::map<std::string, double, std::less<>> truth{
      {"C_f", p.C_f}, {"C_r", p.C_r}, {"I_z", p.I_z}, {"understeer_gradient", understeer_gradient(p)}};
  if (std::isfinite(p.mu)) truth["mu"] = p.mu;
  return truth;
}

/// Measured and predicted motion on the hold-out.
std::string prediction_csv(const DriveValidation& v) {
  std::string text =
      "time[s],stretch,steer[rad],speed[m/s],yaw_rate[rad/s],yaw_rate_predicted[rad/s],accel_y[m/s^2],"
      "accel_y_predicted[m/s^2],lateral_velocity_predicted[m/s]\n";
  const auto cell = [](const std::vector<double>& values, std::size_t k) {
    return k < values.size() && std::isfinite(values[k]) ? fmt::format("{:.9g}", values[k]) : std::string();
  };
  for (std::size_t d = 0; d < v.stretches.size(); ++d) {
    const PredictedStretch& drive = v.stretches[d];
    for (std::size_t k = 0; k < drive.time.size(); ++k) {
      text += fmt::format("{:.9g},{},{},{},{},{},{},{},{}\n", drive.time[k], d + 1, cell(drive.steer, k),
                          cell(drive.speed, k), cell(drive.yaw_rate, k), cell(drive.yaw_rate_predicted, k),
                          cell(drive.accel_y, k), cell(drive.accel_y_predicted, k),
                          cell(drive.lateral_velocity_predicted, k));
    }
  }
  return text;
}

/// `open_loop_path.csv`; nothing where neither heading nor positions were recorded.
void write_path(OutputFolder& folder, const DrivePath& path) {
  if (!path.available()) return;
  Recording recording;
  recording.source = "open_loop_path.csv";
  recording.frame = Frame::kFlu;
  const TimeBase time = make_time_base(path.time);
  const auto add = [&](const char* name, const char* unit, const std::vector<double>& values) {
    recording.add(make_channel(name, unit, time, values));
  };
  if (path.heading) {
    add("yaw", "rad", path.yaw);
    add("yaw_model", "rad", path.yaw_model);
  }
  if (path.position) {
    add("pos_x", "m", path.x);
    add("pos_x_model", "m", path.x_model);
    add("pos_y", "m", path.y);
    add("pos_y_model", "m", path.y_model);
  }
  folder.write("open_loop_path.csv", io::to_csv(recording));
}

std::vector<std::string> path_lines(const DrivePath& path) {
  std::vector<std::string> lines;
  if (path.heading)
    lines.push_back(fmt::format("  open loop    heading: RMSE {:.3g} deg, {:.3g} deg off at the end",
                                path.heading->rmse / kDegree, path.heading->at_end / kDegree));
  if (path.position)
    lines.push_back(fmt::format("  open loop    path: RMSE {:.3g} m ({:.3g} m across), {:.3g} m off after {:.0f} m",
                                path.position->rmse, path.across_rmse, path.position->at_end, path.distance_m));
  return lines;
}

void write_results(OutputFolder& folder, const PreparedDrive& drive, const VehicleAnalysis& analysis,
                   bool validation_only) {
  const VehicleIdentification& id = analysis.identification;
  folder.write("validation.csv", prediction_csv(id.validation));
  write_open_loop(folder, analysis.open_loop, Frame::kFlu);
  write_path(folder, analysis.open_loop.path);
  write_profiles(folder, id.profiles, profiled_parameters(id));
  if (drive.run) {
    folder.write("truth.csv", io::to_csv(to_recording(drive.run->trajectory)));
    folder.write("recording.csv", io::to_csv(*drive.run->measured));
  }
  if (!validation_only && id.best() != nullptr) {
    Vehicle identified;
    identified.name = drive.study.subject_name;
    identified.parameters = id.identified;
    if (id.verdict != estimation::GroupVerdict::kRejected)
      identified = estimated_vehicle(std::move(identified), id.best()->parameters, drive.study.identify.model);
    folder.write("subject.toml", estimation::graded_toml(write_vehicle_toml(identified), analysis.estimate.judgement));
  }
  report::DriveReportContext context{.program = program_name()};
  context.validation_only = validation_only;
  folder.write("report.html", report::to_html(report::drive_report(drive.study, analysis, context)));
}

/// The scores by state, of the path too.
Summary open_loop_scores(const DriveOpenLoop& open_loop) {
  Summary scores = open_loop_summary(open_loop);
  const DrivePath& path = open_loop.path;
  if (path.heading)
    scores["yaw"] = Summary::object(
        {{"rmse", path.heading->rmse / kDegree}, {"at_end", path.heading->at_end / kDegree}, {"unit", "deg"}});
  if (path.position)
    scores["position"] = Summary::object({{"rmse", path.position->rmse},
                                          {"at_end", path.position->at_end},
                                          {"across_rmse", path.across_rmse},
                                          {"way", path.distance_m},
                                          {"unit", "m"}});
  return scores;
}

MoreResults more_of(const VehicleAnalysis& analysis) {
  const estimation::ProfileResult& profiles = analysis.identification.profiles;
  MoreResults more{.lines = profile_lines(profiles)};
  for (const auto& lines : {open_loop_lines(analysis.open_loop), path_lines(analysis.open_loop.path)})
    more.lines.insert(more.lines.end(), lines.begin(), lines.end());
  if (!profiles.profiles.empty()) more.summary.emplace_back("profiles", profiles_summary(profiles));
  if (analysis.open_loop.available() || analysis.open_loop.path.available())
    more.summary.emplace_back("open_loop", open_loop_scores(analysis.open_loop));
  return more;
}

}  // namespace

PreparedDrive prepare_drive(const Study& study, Progress& progress) {
  PreparedDrive drive;
  if (names_recording(study.root())) {
    finish_drive_study(study.root(), progress);
    drive.study = vehicle::read_study(study, progress);
    return drive;
  }
  if (!study.root().has("drive"))
    study.root().fail("data", "is missing: the study names no recording, and no [drive] that could be simulated");
  SimulationStudy vehicle = read_simulation_study(study.root(), progress);
  finish_drive_study(study.root(), progress, DriveTables::kSimulation);
  if (!vehicle.sensors) vehicle.sensors = reference_drive_sensors();
  progress.stage(fmt::format("driving {:.0f} s of {}", vehicle.simulation.duration, vehicle.vehicle.name));
  drive.run = run_simulation_study(vehicle, progress);
  if (drive.run->trajectory.end == vehicle::DriveEnd::kInterrupted) throw Interrupted();
  if (!drive.run->trajectory.usable()) throw std::runtime_error(drive.run->trajectory.message());
  Recording measured = *drive.run->measured;
  measured.source = "simulated drive";
  drive.study = vehicle::read_study(study, measured, progress);
  drive.study.inputs = vehicle.inputs;
  drive.study.truth = truth_of(vehicle.vehicle, vehicle.four_wheel.gravity);
  return drive;
}

void publish_drive(const StudyRun& run, OutputFolder& folder, const PreparedDrive& drive,
                   const VehicleAnalysis& analysis) {
  write_results(folder, drive, analysis, run.command == "validate");
  publish_analysis(folder, run.record(drive.study.seed, drive.study.inputs), run.options(), analysis,
                   more_of(analysis));
}

}  // namespace veridyn::app
