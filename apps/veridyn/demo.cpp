// veridyn demo: the full pipeline on a built-in aircraft and a simulated flight, a car and its scaled model, and an arm
// that lifts a weight, and the car's double lane change on a motion platform; needs no file.

#include "apps/veridyn/run/domains.hpp"

namespace veridyn::app {
namespace {

constexpr const char* kDemoStudy =
    R"(# The study of `veridyn demo`: a built-in aircraft flown in turbulence with the reference sensors, then identified from
# what they recorded. The truth is known, so the report shows it alongside every estimate.
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

constexpr const char* kCueingDemo =
    R"(# The platform's part of `veridyn demo`: the reference car changes lanes twice, and a driver feels it on a platform that
# rolls, pitches and heaves. Which algorithm feels more like the car?
title = "double lane change on a motion platform"

[cue]
algorithms = ["tilt", "three_axis", "mpc"]

[platform]
subject = "three_axis"

[subject]
kind = "vehicle"
builtin = "reference"
mu = 0.95
tyre = "magic formula"

[drive]
model = "four-wheel"
manoeuvre = "double lane change"
speed = "80 km/h"
)";

/// Runs a study of the demo, which is written alongside its results in `folder` of --out.
StudyRun part(const Arguments& arguments, const std::string& folder, const char* text) {
  StudyRun run = parse_study("demo", (std::filesystem::path(arguments.common.out) / folder / "study.toml").string(),
                             text, arguments);
  run.text_to_write = text;
  run.arguments.common.out = run.path.parent_path().string();
  return run;
}

int demo(const Arguments& arguments) {
  if (const int code = identify_aircraft(part(arguments, "aircraft", kDemoStudy)); code != kDone) return code;
  // The overrides are meant for the aircraft's study, and the summary is the aircraft's.
  Arguments rest = arguments;
  rest.common.overrides.clear();
  rest.common.seed.reset();
  rest.common.json = false;
  if (const int code = identify_vehicle(part(rest, "vehicle", kVehicleDemo)); code != kDone) return code;
  StudyRun scale = part(rest, "vehicle", kVehicleDemo);
  scale.text_to_write.clear();
  scale.arguments.common.out += "/scale";
  if (const int code = scale_vehicle(scale); code != kDone) return code;
  if (const int code = simulate_muscle(part(rest, "muscle", kMuscleDemo)); code != kDone) return code;
  return cue_platform(part(rest, "cueing", kCueingDemo));
}

}  // namespace

Command demo_command() {
  return {.name = "demo",
          .summary = "complete runs on a built-in aircraft, a car, an arm and a motion platform; needs no input",
          .default_out = "out/demo",
          .example = "veridyn demo --seed 3",
          .run = demo};
}

}  // namespace veridyn::app
