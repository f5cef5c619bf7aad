#pragma once

#include <string>
#include <utility>

#include "veridyn/muscle/muscle_study.hpp"
#include "veridyn/muscle/study/muscle_run.hpp"

namespace veridyn::report::test {

/// A study of the built-in arm and what came of it.
struct SimulatedArm {
  muscle::MuscleStudy study;
  muscle::MuscleResult result;
};

/// @param motion, subject lines of these tables of the study
inline SimulatedArm simulated_arm(const std::string& motion, const std::string& subject = "") {
  const Study study = Study::parse("[subject]\nmodel = \"arm\"\n" + subject + "[motion]\n" + motion, "s.toml");
  Progress progress;
  muscle::MuscleStudy read = muscle::read_study(study, progress);
  muscle::MuscleResult result = muscle::run_study(read, progress);
  return {std::move(read), std::move(result)};
}

/// The elbow goes from 20 to 90 deg in half a second.
inline const std::string kLift =
    "method = \"static optimization\"\nduration = 0.5\nrate = 40\n[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\n"
    "from = \"20 deg\"\nto = \"90 deg\"\nduration = 0.5\n";
/// A kilogram in the hand.
inline const std::string kLoad = "[[subject.load]]\nbody = \"forearm\"\nmass = 1\nlocation = [0, -0.3, 0]\n";

}  // namespace veridyn::report::test
