// veridyn simulate STUDY of a vehicle: a manoeuvre on a road, what its sensors record of it, and a report.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/deg_per_g.hpp"
#include "veridyn/estimation/judgement/subject_grades.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/vehicle_report.hpp"
#include "veridyn/vehicle/simulation/trajectory_table.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::vehicle;

Summary summary_of(const std::filesystem::path& folder, const SimulationStudy& study, const SimulationRun& run) {
  Summary s;
  s["folder"] = folder.string();
  s["vehicle"] = study.vehicle.name;
  s["model"] = to_string(study.model);
  s["manoeuvre"] = to_string(study.manoeuvre.kind);
  s["completed"] = run.trajectory.end == vehicle::DriveEnd::kCompleted;
  s["message"] = run.trajectory.message();
  s["end_time_s"] = run.trajectory.end_time;
  s["rows"] = run.trajectory.size();
  s["metrics"] = Summary::array();
  for (const Metric& m : run.metrics)
    s["metrics"].push_back(
        Summary::object({{"name", m.name}, {"value", m.value}, {"unit", m.unit}, {"source", m.source}}));
  const auto values = to_array(run.characteristics);
  for (std::size_t i = 0; i < values.size(); ++i)
    s["characteristics"][kBicycleCharacteristicFields[i].name] = values[i];
  if (run.cornering) {
    s["steady_cornering"]["understeer_gradient_deg_per_g"] = deg_per_g(run.cornering->understeer_gradient);
    s["steady_cornering"]["roll_gradient_deg_per_g"] = deg_per_g(run.cornering->roll_gradient);
  }
  s["lift_offs"] = Summary::array();
  for (const LiftOff& l : run.trajectory.lift_offs)
    s["lift_offs"].push_back(Summary::object({{"wheel", kWheelNames[l.wheel]}, {"from_s", l.from}, {"to_s", l.to}}));
  s["warnings"] = study.vehicle.warnings;
  return s;
}

}  // namespace

int simulate_vehicle(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  TerminalProgress progress = progress_of(run.options());
  const SimulationStudy vehicle = read_simulation_study(run.study.root(), progress);
  finish_drive_study(run.study.root(), progress, DriveTables::kSimulation);
  progress.stage(fmt::format("driving {:.0f} s of {}", vehicle.simulation.duration, vehicle.vehicle.name));
  const SimulationRun driven = run_simulation_study(vehicle, progress);
  const VehicleTrajectory& trajectory = driven.trajectory;
  if (trajectory.end == vehicle::DriveEnd::kInterrupted) throw Interrupted();
  if (!trajectory.usable()) throw std::runtime_error(trajectory.message());
  folder.write("motion.csv", io::to_csv(to_recording(trajectory)));
  if (driven.measured) folder.write("recording.csv", io::to_csv(*driven.measured));
  std::string metrics = "metric,value,unit,source\n";
  for (const Metric& m : driven.metrics) metrics += fmt::format("{},{},{},{}\n", m.name, m.value, m.unit, m.source);
  folder.write("metrics.csv", metrics);
  folder.write("subject.toml",
               write_vehicle_toml(vehicle.vehicle) + estimation::grades_table(run.study.root().table("subject")));
  folder.write("report.html", report::to_html(report::vehicle_report(vehicle, driven, program_name())));
  const std::string files = fmt::format("{}", fmt::join(folder.files(), ", "));
  folder.publish(run.record(vehicle.seed, vehicle.inputs), run.options(), summary_of(folder.path(), vehicle, driven));
  for (const std::string& warning : vehicle.vehicle.warnings) print_line(run.options(), "warning: " + warning);
  const auto& a = trajectory.lateral_acceleration;
  const double most = std::abs(
      *std::max_element(a.begin(), a.end(), [](double one, double other) { return std::abs(one) < std::abs(other); }));
  print_line(run.options(),
             fmt::format("{} of {}: {}; at most {:.2f} m/s^2 sideways", to_string(vehicle.manoeuvre.kind),
                         vehicle.vehicle.name, trajectory.message(), most));
  if (driven.cornering) {
    print_line(run.options(), fmt::format("gentle steady turns: understeer gradient {:.2f} deg/g, roll gradient {:.2f} "
                                          "deg/g",
                                          deg_per_g(driven.cornering->understeer_gradient),
                                          deg_per_g(driven.cornering->roll_gradient)));
  }
  print_line(run.options(), fmt::format("wrote {} in {}", files, folder.path().string()));
  return kDone;
}

}  // namespace veridyn::app
