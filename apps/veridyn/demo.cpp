// veridyn demo: the whole way on a built-in aircraft and a simulated flight, a car and its scaled model, and an arm
// that lifts a weight; needs no file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/veridyn/drive.hpp"
#include "apps/veridyn/results.hpp"
#include "apps/veridyn/scale.hpp"
#include "apps/veridyn/simulate_muscle.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/progress.hpp"

namespace veridyn::app {
namespace {

constexpr const char* kDemoStudy =
    R"(# The study of `veridyn demo`: a built-in aircraft flown in turbulence with the reference sensors, then identified from
# what they recorded. The truth is known, so the report shows it beside every estimate.
title = "demo"
seed = 1

[subject]
builtin = "unatrap"

[flight]
duration = 300
airspeed = 20
wind = [4, -2, 0]
turbulence = "low_moderate"

[reconstruct]
sensors = "reference"
turbulence = "low_moderate"
)";

constexpr const char* kMuscleDemo =
    R"(# The muscles' part of `veridyn demo`: which excitations bend the elbow of the built-in arm with 1 kg in the hand?
title = "elbow flexion with 1 kg"

[subject]
model = "arm"
locked = ["shoulder_flexion"]

[[subject.load]]
body = "forearm"
mass = "1 kg"
location = [0, -0.30, 0]

[motion]
method = "computed muscle control"
duration = 1.1

[[motion.ramp]]
coordinate = "elbow_flexion"
from = "10 deg"
to = "110 deg"
start = 0.05
duration = 1
)";

int muscle_demo(const CommonOptions& options) {
  CommonOptions own = options;
  own.out = (std::filesystem::path(options.out) / "muscle").string();
  own.json = false;  // the summary is the aircraft's
  make_folder(own.out);
  const std::string path = (std::filesystem::path(own.out) / "study.toml").string();
  write_file(path, kMuscleDemo);
  // Overrides are meant for the aircraft's study.
  return simulate_muscle(Study::load(path), path, own, "demo");
}

constexpr const char* kVehicleDemo =
    R"(# The vehicle's part of `veridyn demo`: the reference car is driven with random steering, then found again from what
# production-car sensors recorded; and compared with its published model of one fifth the size.
title = "reference car"
seed = 1

[subject]
kind = "vehicle"
builtin = "reference"

[drive]
model = "bicycle"
manoeuvre = "random steer"
amplitude = "2 deg"
high = 2.0
length = 60

[sensors]
set = "reference"

[scale]
length_ratio = 0.2
mass = "8.8 kg"
speed = "4 m/s"
[scale.model]
builtin = "reference_1to5"
)";

int vehicle_demo(const CommonOptions& options) {
  CommonOptions own = options;
  own.out = (std::filesystem::path(options.out) / "vehicle").string();
  own.json = false;  // the summary is the aircraft's
  make_folder(own.out);
  const std::string path = (std::filesystem::path(own.out) / "study.toml").string();
  write_file(path, kVehicleDemo);
  const int exit_code = identify_vehicle(Study::load(path), path, own, "demo");
  if (exit_code != kDone) return exit_code;
  own.out = (std::filesystem::path(own.out) / "scale").string();
  return scale_vehicle(Study::load(path), path, own, "demo");
}

int aircraft_demo(const CommonOptions& options) {
  const std::filesystem::path folder = std::filesystem::path(options.out) / "aircraft";
  make_folder(folder);
  write_file(folder / "study.toml", kDemoStudy);
  const Study study = load_study((folder / "study.toml").string(), options);
  TerminalProgress progress(options.quiet);
  aircraft::FlightStudy flight = aircraft::read_study(study, progress);
  const aircraft::FlightAnalysis analysis = aircraft::identify(flight, progress);
  if (analysis.interrupted) {
    fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
    return kFailed;
  }
  progress.stage("writing the results");
  write_identification(folder, flight, analysis,
                       {"demo", study.name(), study.to_toml(), flight.seed, {folder / "study.toml"}}, options);
  tell_identification(analysis, folder, options);
  print_summary(summary_of(analysis, folder), options);
  return kDone;
}

int demo(const CommonOptions& options) {
  int exit_code = aircraft_demo(options);
  if (exit_code == kDone) exit_code = vehicle_demo(options);
  return exit_code == kDone ? muscle_demo(options) : exit_code;
}

}  // namespace

void add_demo(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<CommonOptions>();
  CLI::App* verb =
      program.add_subcommand("demo", "complete runs on a built-in aircraft, a car and an arm; needs no input");
  add_common(*verb, *options, "out/demo", "veridyn demo --seed 3");
  verb->callback([options, &exit_code] { exit_code = demo(*options); });
}

}  // namespace veridyn::app
