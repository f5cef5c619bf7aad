// What does a driver feel of a lane change on a small motion platform, and which algorithm comes closest?
//
// A simulated car drives the manoeuvre; the platform rolls, pitches and heaves, but cannot slide sideways: it leans the
// driver over, so that gravity takes the place of the lateral force. With `[data]` in place of `[subject]` and
// `[drive]` the drive is a recorded one.
#include <cstdio>
#include <exception>
#include <vector>

#include "picture.hpp"
#include "veridyn/cueing.hpp"

int main() try {
  using namespace veridyn;
  const Study study = Study::parse(R"(
    [cue]
    algorithms = ["three_axis", "optimal"]
    driver = [0.2, 0.35, 0.5]
    optimum = false
    [platform]
    subject = "three_axis"
    [subject]
    kind = "vehicle"
    builtin = "reference"
    tyre = "magic formula"
    mu = 0.95
    [drive]
    model = "four-wheel"
    manoeuvre = "double lane change"
    speed = "80 km/h"
  )",
                                   "example 09");
  Progress silent;
  const cueing::CueingStudy drive = cueing::read_study(study, silent);
  const cueing::CueingResult result = cueing::cue(drive, silent);

  // Lateral force as the organs of balance report it, in the car and on the platform; the platform's axes are forward,
  // right, down.
  bool within_limits = true;
  for (const cueing::AlgorithmResult& algorithm : result.algorithms) {
    const cueing::CueScore& sway = algorithm.score.cues[cueing::Cue::kSway];
    const cueing::AxisScore& roll = algorithm.score.axes[cueing::PlatformAxis::kRoll];
    std::printf(
        "%-10s lateral force: correlation %.2f, %.2f s late; platform rolls %+.1f to %+.1f deg, false cues: %zu\n",
        algorithm.score.algorithm.c_str(), sway.at_lag.value, sway.lag.value, roll.lowest / kDegree,
        roll.highest / kDegree, algorithm.score.false_cues.size());
    within_limits = within_limits && roll.used <= 1.0;
  }

  const cueing::FeltMotion &simple = result.algorithms[0].felt, &optimal = result.algorithms[1].felt;
  const cueing::CuePair& sway = optimal.felt[cueing::Cue::kSway];
  std::vector<double> roll;
  for (const cueing::CueingStep& step : result.algorithms[1].run.steps)
    roll.push_back(cueing::position(step.reached, cueing::PlatformAxis::kRoll) / kDegree);
  picture::write("09_cue_a_drive.csv", {{"time[s]", optimal.time},
                                        {"car[m/s^2]", sway.vehicle},
                                        {"three_axis[m/s^2]", simple.felt[cueing::Cue::kSway].platform},
                                        {"optimal[m/s^2]", sway.platform},
                                        {"roll[deg]", roll}});
  return within_limits && result.algorithms[1].score.cues[cueing::Cue::kSway].at_lag.value > 0.5 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
