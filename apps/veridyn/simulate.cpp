// veridyn simulate STUDY: fly an aircraft and write what its sensors record, and the truth; or drive a vehicle; or move
// a musculoskeletal model.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/veridyn/output.hpp"
#include "apps/veridyn/simulate_muscle.hpp"
#include "apps/veridyn/simulate_vehicle.hpp"
#include "veridyn/aircraft/simulation/simulate_study.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/muscle/muscle_study.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::app {
namespace {

struct Options {
  std::string study;
  CommonOptions common;
};

int simulate(const Options& options) {
  const Study study = load_study(options.study, options.common);
  if (muscle::is_muscle_study(study.root())) return simulate_muscle(study, options.study, options.common);
  if (vehicle::is_vehicle_study(study.root())) return simulate_vehicle(study, options.study, options.common);
  const aircraft::SimulationOptions simulation = aircraft::read_simulation(study.root());
  // Tables that only the analysis of the flight reads; misspelt keys in them are found by `identify`.
  for (const char* table : {"title", "data", "delays", "reconstruct", "signals", "segments", "identify", "validate",
                            "track", "uncertainty"}) {
    static_cast<void>(study.root().has(table));
  }
  study.root().finish();
  TerminalProgress progress(options.common.quiet);
  progress.stage(fmt::format("simulating {:.0f} s of {}", simulation.duration, simulation.subject.name));
  const aircraft::SimulatedFlight flight = aircraft::simulate(simulation, progress);
  if (flight.end == aircraft::SimulationEnd::kInterrupted) {
    fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
    return kFailed;
  }
  if (!flight.usable()) {
    fmt::print(stderr, "veridyn: {}\n", flight.message());
    return kFailed;
  }
  const std::filesystem::path folder = options.common.out;
  make_folder(folder);
  io::write_csv(flight.truth, folder / "truth.csv");
  io::write_csv(flight.measured, folder / "recording.csv");
  write_file(folder / "subject.toml", aircraft::write_subject_toml(simulation.subject));
  RunRecord run{"simulate", study.name(), study.to_toml(), simulation.seed, {options.study}};
  write_run_record(folder, run, options.common);
  constexpr double kDegree = std::numbers::pi / 180.0;
  tell(options.common, fmt::format("{:.0f} s flown, alpha from {:.1f} to {:.1f} deg with gusts; wrote {} and {}",
                                   flight.end_time, flight.alpha_min / kDegree, flight.alpha_max / kDegree,
                                   (folder / "recording.csv").string(), (folder / "truth.csv").string()));
  nlohmann::ordered_json summary;
  summary["folder"] = folder.string();
  summary["duration_s"] = flight.end_time;
  summary["channels"] = flight.measured.names();
  print_summary(summary, options.common);
  return kDone;
}

}  // namespace

void add_simulate(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      program.add_subcommand("simulate", "fly a known aircraft, drive a vehicle, or move a musculoskeletal model");
  verb->add_option("STUDY", options->study,
                   "study file (TOML). Aircraft: [subject], [flight] and [sensors]; writes what its sensors record and "
                   "the truth. Vehicle: [subject] with kind = \"vehicle\", [drive], and where wanted [road] and "
                   "[sensors]. Muscles: [subject] with `model` (an .osim file or \"arm\") and [motion] with `method` "
                   "(forward, inverse dynamics, static optimization, computed muscle control); writes motion, muscle "
                   "states, controls and a report. `veridyn init muscle` writes one to start from")
      ->required();
  add_common(*verb, options->common, "out/simulate",
             "veridyn simulate simulated_flight.toml --seed 7\n"
             "  veridyn simulate elbow.toml --out out/elbow --set motion.rate=1000");
  verb->callback([options, &exit_code] { exit_code = simulate(*options); });
}

}  // namespace veridyn::app
