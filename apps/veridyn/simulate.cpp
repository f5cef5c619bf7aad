// veridyn simulate STUDY: fly an aircraft and write what its sensors record, and the truth. Vehicles and
// musculoskeletal models: simulate_vehicle.cpp, simulate_muscle.cpp.
#include <fmt/format.h>

#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/aircraft/simulation/simulate_study.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/io/tables/csv.hpp"

namespace veridyn::app {

int simulate_aircraft(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  const aircraft::SimulationOptions simulation = aircraft::read_simulation(run.study.root());
  finish_flight_study(run.study.root());
  TerminalProgress progress = progress_of(run.options());
  progress.stage(fmt::format("simulating {:.0f} s of {}", simulation.duration, simulation.subject.name));
  const aircraft::SimulatedFlight flight = aircraft::simulate(simulation, progress);
  if (flight.end == aircraft::FlightEnd::kInterrupted) throw Interrupted();
  if (!flight.usable()) throw std::runtime_error(flight.message());
  folder.write("truth.csv", io::to_csv(flight.truth));
  folder.write("recording.csv", io::to_csv(flight.measured));
  folder.write("subject.toml", aircraft::write_subject_toml(simulation.subject));
  Summary summary;
  summary["folder"] = folder.path().string();
  summary["duration_s"] = flight.end_time;
  summary["channels"] = flight.measured.names();
  folder.publish(run.record(simulation.seed), run.options(), summary);
  print_line(run.options(),
             fmt::format("{:.0f} s flown, alpha from {:.1f} to {:.1f} deg with gusts; wrote {} and {}", flight.end_time,
                         flight.alpha_min / kDegree, flight.alpha_max / kDegree,
                         (folder.path() / "recording.csv").string(), (folder.path() / "truth.csv").string()));
  return kDone;
}

Command simulate_command() {
  return {
      .name = "simulate",
      .summary = "fly a known aircraft, drive a vehicle, or move a musculoskeletal model",
      .arguments =
          {{.name = "STUDY",
            .help =
                "study file (TOML). Aircraft: [subject], [flight] and [sensors]; writes what its sensors record and "
                "the truth. Vehicle: [subject] with kind = \"vehicle\", [drive], and optionally [road] and "
                "[sensors]. Muscles: [subject] with `model` (an .osim file or \"arm\") and [motion] with `method` "
                "(forward, inverse dynamics, static optimization, computed muscle control); writes motion, muscle "
                "states, controls and a report. `veridyn init muscle` writes one to start from",
            .required = true}},
      .default_out = "out/simulate",
      .example =
          "veridyn simulate simulated_flight.toml --seed 7\n"
          "  veridyn simulate elbow.toml --out out/elbow --set motion.rate=1000",
      .run = [](const Arguments& arguments) { return run_on_study("simulate", arguments); }};
}

}  // namespace veridyn::app
