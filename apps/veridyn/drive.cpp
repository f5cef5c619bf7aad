// veridyn identify, validate and track STUDY of a vehicle's drive.
#include "apps/veridyn/drive.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/veridyn/output.hpp"
#include "apps/veridyn/results.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/numerics/parallel.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/drive_report.hpp"
#include "veridyn/report/drive_tracking_report.hpp"
#include "veridyn/vehicle/simulation/trajectory_table.hpp"
#include "veridyn/vehicle/simulation_study.hpp"
#include "veridyn/vehicle/track_drive.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::vehicle;

struct Drive {
  VehicleStudy study;
  std::vector<std::pair<std::string, double>> truth;  ///< of a simulated drive
  std::optional<SimulationRun> run;
};

std::vector<std::pair<std::string, double>> truth_of(const Vehicle& vehicle, double gravity) {
  VehicleParameters<double> p = vehicle.parameters;
  const auto [C_f, C_r] = cornering_stiffnesses(vehicle, gravity);
  p.C_f = C_f;
  p.C_r = C_r;
  std::vector<std::pair<std::string, double>> truth{
      {"C_f", p.C_f}, {"C_r", p.C_r}, {"I_z", p.I_z}, {"understeer_gradient", understeer_gradient(p)}};
  if (std::isfinite(p.mu)) truth.emplace_back("mu", p.mu);
  return truth;
}

/// The recorded drive, or one that is simulated first; nothing when interrupted.
std::optional<Drive> prepare(const Study& study, Progress& progress) {
  Drive drive;
  if (study.root().has("data") && (study.root().table("data").has("file") || study.root().table("data").has("files") ||
                                   study.root().table("data").has("runs"))) {
    drive.study = read_study(study, progress);
    for (const char* table : {"drive", "road", "sensors", "scale"}) static_cast<void>(study.root().has(table));
    study.root().finish();
    return drive;
  }
  if (!study.root().has("drive"))
    study.root().fail("data", "is missing: the study names no recording, and no [drive] that could be simulated");
  SimulationStudy vehicle = read_simulation_study(study.root());
  if (!vehicle.sensors) vehicle.sensors = reference_drive_sensors();
  progress.stage(fmt::format("driving {:.0f} s of {}", vehicle.simulation.duration, vehicle.vehicle.name));
  drive.run = run_simulation_study(vehicle, progress);
  if (drive.run->trajectory.end == SimulationEnd::kInterrupted) return std::nullopt;
  if (!drive.run->trajectory.usable()) throw std::runtime_error(drive.run->trajectory.message());
  Recording measured = *drive.run->measured;
  measured.source = "simulated drive";
  drive.study = read_study(study, measured, progress);
  drive.study.inputs = vehicle.inputs;
  drive.truth = truth_of(vehicle.vehicle, vehicle.four_wheel.gravity);
  static_cast<void>(study.root().has("scale"));
  study.root().finish();
  return drive;
}

int interrupted() {
  fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
  return kFailed;
}

/// Every method's figures, the chosen one first.
std::string methods_csv(const VehicleIdentification& id) {
  std::string text = "parameter,method,value,sigma,low95,high95,unit\n";
  const auto lines = [&](const VehicleEstimate& e) {
    if (!e.usable) return;
    for (const estimation::ParameterEstimate& p : e.parameters)
      text += fmt::format("{},{},{},{},{},{},{}\n", p.name, to_string(e.method), p.value, p.sigma, p.low95, p.high95,
                          p.unit);
  };
  if (id.best() != nullptr) lines(*id.best());
  for (const VehicleEstimate& e : id.estimates)
    if (&e != id.best()) lines(e);
  return text;
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

void write_results(const std::filesystem::path& folder, const Drive& drive, const VehicleAnalysis& analysis,
                   bool validation_only) {
  make_folder(folder);
  const VehicleIdentification& id = analysis.identification;
  write_file(folder / "estimate.json", io::to_json(analysis.estimate));
  write_file(folder / "parameters.csv", parameters_csv(analysis.estimate));
  write_file(folder / "methods.csv", methods_csv(id));
  write_file(folder / "validation.csv", prediction_csv(id.validation));
  if (drive.run) {
    io::write_csv(to_recording(drive.run->trajectory), folder / "truth.csv");
    io::write_csv(*drive.run->measured, folder / "recording.csv");
  }
  if (!validation_only && id.best() != nullptr) {
    Vehicle identified;
    identified.name = drive.study.subject_name;
    identified.parameters = id.identified;
    write_file(folder / "subject.toml", write_vehicle_toml(identified));
  }
  report::DriveReportContext context{.program = "veridyn " VERIDYN_VERSION, .truth = drive.truth};
  context.validation_only = validation_only;
  report::write_html(report::drive_report(drive.study, analysis, context), folder / "report.html");
}

void tell_analysis(const VehicleAnalysis& analysis, const std::filesystem::path& folder, const CommonOptions& options) {
  const VehicleIdentification& id = analysis.identification;
  if (const VehicleEstimate* best = id.best()) {
    for (const estimation::ParameterEstimate& p : best->parameters) {
      tell(options, fmt::format("  {:<20} {:>12.5g} +- {:<9.2g} {:<12} {}", p.name, p.value, p.sigma, p.unit,
                                estimation::to_string(p.status)));
    }
  }
  for (const PredictedDriveQuantity& q : id.validation.quantities) {
    tell(options, fmt::format("  hold-out {:<16} R2 {:.3f}, RMSE {:.3g} {}", q.name, q.fit.r2, q.fit.rmse, q.unit));
  }
  for (const std::string& warning : analysis.estimate.warnings) tell(options, "warning: " + warning);
  tell(options, id.reason);
  tell(options, fmt::format("report: {}", (folder / "report.html").string()));
}

nlohmann::ordered_json summary_of(const VehicleAnalysis& analysis, const std::filesystem::path& folder) {
  nlohmann::ordered_json s;
  s["folder"] = folder.string();
  s["verdict"] = to_string(analysis.identification.verdict);
  s["reason"] = analysis.identification.reason;
  s["estimate"] = nlohmann::ordered_json::parse(io::to_json(analysis.estimate));
  return s;
}

/// Writes, tells and summarises what identification or validation made of a drive.
int finish(const Study& study, const std::vector<std::filesystem::path>& inputs, const std::string& verb,
           const Drive& drive, const VehicleAnalysis& analysis, const CommonOptions& options) {
  const std::filesystem::path folder = options.out;
  write_results(folder, drive, analysis, verb == "validate");
  RunRecord record{verb, study.name(), study.to_toml(), drive.study.seed, drive.study.inputs};
  record.inputs.insert(record.inputs.end(), inputs.begin(), inputs.end());
  write_run_record(folder, record, options);
  tell_analysis(analysis, folder, options);
  print_summary(summary_of(analysis, folder), options);
  return kDone;
}

std::string change_line(const DriveChange& c) {
  return fmt::format("{:9.1f} s  {} changed, began at about {:.1f} s", c.change.detected_s,
                     kTrackedAxleNames[static_cast<std::size_t>(c.axle)], c.change.began_s);
}

std::string live_line(const TrackedDrive& drive) {
  const DriveTracker* t = drive.tracker();
  if (t == nullptr) return "waits for the drive to begin";
  std::string text = fmt::format("{:9.1f} s ", t->last_time());
  for (std::size_t i = 0; i < kTrackedAxles; ++i) {
    const auto axle = static_cast<TrackedAxle>(i);
    text += fmt::format(" {} {:.4g} +- {:.2g}", kTrackedAxleNames[i], t->value(axle), t->sigma(axle));
  }
  return text;
}

void write_tracking(const Study& study, const std::string& path, const Drive& drive, const TrackedDrive& tracked,
                    const CommonOptions& options) {
  const std::filesystem::path folder = options.out;
  make_folder(folder);
  const estimation::Estimate estimate = tracked.estimate();
  write_file(folder / "estimate.json", io::to_json(estimate));
  std::string changes = "what,kind,detected[s],began[s],shift\n";
  nlohmann::ordered_json summary;
  summary["verdict"] = estimate.verdict;
  summary["folder"] = folder.string();
  summary["changes"] = nlohmann::ordered_json::array();
  if (const DriveTracker* tracker = tracked.tracker()) {
    io::write_csv(history_recording(*tracker), folder / "track.csv");
    for (const DriveChange& c : tracker->changes()) {
      const std::string_view name = kTrackedAxleNames[static_cast<std::size_t>(c.axle)];
      changes +=
          fmt::format("{},{},{},{},{}\n", name, c.change.kind == estimation::ChangeKind::kMean ? "mean" : "spread",
                      c.change.detected_s, c.change.began_s, c.change.shift);
      summary["changes"].push_back({{"what", name}, {"detected_s", c.change.detected_s}});
    }
  }
  write_file(folder / "changes.csv", changes);
  const report::DriveReportContext context{.program = "veridyn " VERIDYN_VERSION, .truth = drive.truth};
  report::write_html(report::drive_tracking_report(drive.study, tracked, context), folder / "report.html");
  RunRecord record{"track", study.name(), study.to_toml(), drive.study.seed, drive.study.inputs};
  record.inputs.emplace_back(path);
  write_run_record(folder, record, options);
  for (const std::string& warning : estimate.warnings) tell(options, "warning: " + warning);
  tell(options, estimate.verdict);
  tell(options,
       fmt::format("changes found: {}; report: {}", summary["changes"].size(), (folder / "report.html").string()));
  summary["warnings"] = estimate.warnings;
  print_summary(summary, options);
}

}  // namespace

int identify_vehicle(const Study& study, const std::string& path, const CommonOptions& options,
                     const std::string& verb) {
  numerics::set_default_threads(options.threads);
  TerminalProgress progress(options.quiet);
  std::optional<Drive> drive = prepare(study, progress);
  if (!drive) return interrupted();
  const VehicleAnalysis analysis = identify(drive->study, progress);
  if (analysis.interrupted) return interrupted();
  return finish(study, {path}, verb, *drive, analysis, options);
}

int validate_vehicle(const Study& study, const std::string& path, const std::string& estimate,
                     const CommonOptions& options) {
  const estimation::Estimate given = io::read_estimate(estimate);
  TerminalProgress progress(options.quiet);
  std::optional<Drive> drive = prepare(study, progress);
  if (!drive) return interrupted();
  const VehicleAnalysis analysis = validate(drive->study, given, progress);
  if (analysis.interrupted) return interrupted();
  return finish(study, {path, estimate}, "validate", *drive, analysis, options);
}

int track_vehicle(const Study& study, const std::string& path, bool live, const FollowOptions& follow,
                  const CommonOptions& options) {
  if (live) {
    Drive drive;
    std::optional<TrackedDrive> tracked;
    follow_files(followed_files(study.root()), follow, options, [&](bool finished) {
      Progress silent;
      drive.study = read_study(study, silent);
      if (!tracked) tracked.emplace(drive.study);
      for (const DriveChange& c : tracked->advance(drive.study.log.mapped, finished, silent))
        tell(options, change_line(c));
      tell(options, live_line(*tracked));
    });
    write_tracking(study, path, drive, *tracked, options);
    return kDone;
  }
  TerminalProgress progress(options.quiet);
  std::optional<Drive> drive = prepare(study, progress);
  if (!drive) return interrupted();
  const DriveTracking tracking = track(drive->study, progress);
  if (tracking.interrupted) return interrupted();
  if (const DriveTracker* tracker = tracking.drive.tracker())
    for (const DriveChange& c : tracker->changes()) tell(options, change_line(c));
  tell(options, live_line(tracking.drive));
  write_tracking(study, path, *drive, tracking.drive, options);
  return kDone;
}

}  // namespace veridyn::app
