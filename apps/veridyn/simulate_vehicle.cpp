// veridyn simulate STUDY of a vehicle: a manoeuvre on a road, what its sensors record of it, and a report.
#include "apps/veridyn/simulate_vehicle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/veridyn/output.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/vehicle_report.hpp"
#include "veridyn/vehicle/simulation/trajectory_table.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::vehicle;

nlohmann::ordered_json summary_of(const std::filesystem::path& folder, const SimulationStudy& study,
                                  const SimulationRun& run) {
  nlohmann::ordered_json s;
  s["folder"] = folder.string();
  s["vehicle"] = study.vehicle.name;
  s["model"] = to_string(study.model);
  s["manoeuvre"] = to_string(study.manoeuvre.kind);
  s["completed"] = run.trajectory.end == SimulationEnd::kCompleted;
  s["message"] = run.trajectory.message();
  s["end_time_s"] = run.trajectory.end_time;
  s["rows"] = run.trajectory.size();
  const auto finite = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  s["metrics"] = nlohmann::ordered_json::array();
  for (const Metric& m : run.metrics)
    s["metrics"].push_back({{"name", m.name}, {"value", finite(m.value)}, {"unit", m.unit}, {"source", m.source}});
  const auto values = to_array(run.characteristics);
  for (std::size_t i = 0; i < values.size(); ++i)
    s["characteristics"][kBicycleCharacteristicFields[i].name] = finite(values[i]);
  s["lift_offs"] = nlohmann::ordered_json::array();
  for (const LiftOff& l : run.trajectory.lift_offs)
    s["lift_offs"].push_back({{"wheel", kWheelNames[l.wheel]}, {"from_s", l.from}, {"to_s", l.to}});
  s["warnings"] = study.vehicle.warnings;
  return s;
}

}  // namespace

int simulate_vehicle(const Study& study, const std::string& path, const CommonOptions& options,
                     const std::string& verb) {
  SimulationStudy vehicle = read_simulation_study(study.root());
  // Tables that other verbs read; misspelt keys in them are found there.
  for (const char* table : {"data", "signals", "segments", "identify", "validate", "track", "scale"})
    static_cast<void>(study.root().has(table));
  study.root().finish();
  TerminalProgress progress(options.quiet);
  progress.stage(fmt::format("driving {:.0f} s of {}", vehicle.simulation.duration, vehicle.vehicle.name));
  const SimulationRun run = run_simulation_study(vehicle, progress);
  if (run.trajectory.end == SimulationEnd::kInterrupted) {
    fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
    return kFailed;
  }
  if (!run.trajectory.usable()) {
    fmt::print(stderr, "veridyn: {}\n", run.trajectory.message());
    return kFailed;
  }
  const std::filesystem::path folder = options.out;
  make_folder(folder);
  io::write_csv(to_recording(run.trajectory), folder / "motion.csv");
  std::string files = "motion.csv";
  if (run.measured) {
    io::write_csv(*run.measured, folder / "recording.csv");
    files += ", recording.csv";
  }
  std::string metrics = "metric,value,unit,source\n";
  for (const Metric& m : run.metrics) metrics += fmt::format("{},{},{},{}\n", m.name, m.value, m.unit, m.source);
  write_file(folder / "metrics.csv", metrics);
  write_file(folder / "subject.toml", write_vehicle_toml(vehicle.vehicle));
  report::write_html(report::vehicle_report(vehicle, run, "veridyn " VERIDYN_VERSION), folder / "report.html");
  RunRecord record{verb, study.name(), study.to_toml(), vehicle.seed, vehicle.inputs};
  record.inputs.emplace_back(path);
  write_run_record(folder, record, options);
  for (const std::string& warning : vehicle.vehicle.warnings) tell(options, "warning: " + warning);
  const auto& a = run.trajectory.lateral_acceleration;
  const double most = std::abs(
      *std::max_element(a.begin(), a.end(), [](double one, double other) { return std::abs(one) < std::abs(other); }));
  tell(options, fmt::format("{} of {}: {}; at most {:.2f} m/s^2 sideways", to_string(vehicle.manoeuvre.kind),
                            vehicle.vehicle.name, run.trajectory.message(), most));
  tell(options, fmt::format("wrote {}, metrics.csv, subject.toml, report.html in {}", files, folder.string()));
  print_summary(summary_of(folder, vehicle, run), options);
  return kDone;
}

}  // namespace veridyn::app
