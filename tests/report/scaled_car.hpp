#pragma once

#include "veridyn/vehicle/scale_study.hpp"

namespace veridyn::report::test {

/// A car and its model of a fifth of the size, exactly similar, through the beginning of a step steer.
struct ScaledCar {
  vehicle::ScaleStudy study;
  vehicle::ScaleAnalysis analysis;
};

inline ScaledCar scaled_twin() {
  const Study study = Study::parse(
      "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmanoeuvre = \"step steer\"\nduration = 2\n"
      "[scale]\nlength_ratio = 0.2\nmass = 8.8\nspeed = 4\n",
      "study.toml");
  Progress silent;
  ScaledCar made{.study = vehicle::read_scale_study(study.root(), silent), .analysis = {}};
  made.analysis = vehicle::run_scale_study(made.study, silent);
  return made;
}

}  // namespace veridyn::report::test
