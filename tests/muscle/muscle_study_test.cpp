#include "veridyn/muscle/muscle_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/muscle/muscle_studies.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

using test::expect_refusals;
using test::kArm;
using test::kFollow;
using test::read_muscle_study;
using testing::ElementsAre;

std::vector<double> excitations_at(const MuscleStudy& study, double time) {
  std::vector<double> u(study.controls.excitation.size());
  study.controls.excitation.evaluate(time, u.data());
  return u;
}

TEST(MuscleStudy, IsOneWhoseSubjectNamesAModel) {
  EXPECT_TRUE(is_muscle_study(Study::parse(kArm, "s.toml").root()));
  EXPECT_FALSE(is_muscle_study(Study::parse("[subject]\nbuiltin = \"thor\"\n", "s.toml").root()));
  // The model of an aircraft is a table.
  EXPECT_FALSE(is_muscle_study(Study::parse("[subject.model]\nCL = [\"1\"]\n", "s.toml").root()));
  EXPECT_FALSE(is_muscle_study(Study::parse("seed = 1\n", "s.toml").root()));
}

TEST(MuscleStudy, ReadsAForwardStudy) {
  const MuscleStudy study =
      read_muscle_study(kArm +
                        "[[subject.load]]\nbody = \"forearm\"\nmass = \"2 kg\"\nlocation = [0, -0.3, 0]\n"
                        "[subject.parameters]\n\"biceps_long.optimal_fiber_length\" = \"15 cm\"\n"
                        "brachialis.max_isometric_force = 900\n"
                        "[motion]\nbegin = 0.5\nduration = 2\nrate = 100\naccuracy = 1e-7\n"
                        "[motion.start]\nelbow_flexion = \"30 deg\"\n"
                        "[motion.start_speed]\nelbow_flexion = \"10 deg/s\"\n"
                        "[motion.excitation]\ndefault = 0.1\nbrachialis = 0.2\n"
                        "[[motion.excitation_step]]\ntime = 1\ndefault = 0.3\nbrachialis = 0.4\n"
                        "[[motion.excitation_step]]\ntime = \"1500 ms\"\ntriceps_long = 0.5\n");
  EXPECT_EQ(study.method, MuscleMethod::kForward);
  EXPECT_EQ(study.begin, 0.5);
  EXPECT_EQ(study.end, 2.5);
  EXPECT_EQ(study.rate_Hz, 100.0);
  EXPECT_EQ(study.accuracy, 1e-7);
  EXPECT_DOUBLE_EQ(study.start.q(1), 30.0 * kDegree);
  EXPECT_DOUBLE_EQ(study.start.qdot(1), 10.0 * kDegree);
  EXPECT_THAT(excitations_at(study, 0.9), ElementsAre(0.1, 0.1, 0.1, 0.1, 0.1, 0.2));
  EXPECT_THAT(excitations_at(study, 1.0), ElementsAre(0.3, 0.3, 0.3, 0.3, 0.3, 0.4));
  EXPECT_THAT(excitations_at(study, 1.5), ElementsAre(0.5, 0.3, 0.3, 0.3, 0.3, 0.4));
  // The load is in the system's masses, not in what is written back; parameters are in both.
  const int forearm = study.written.body("forearm");
  EXPECT_DOUBLE_EQ(study.written.bodies[forearm].mass, 1.5);
  EXPECT_DOUBLE_EQ(study.system->model().bodies[forearm].mass, 3.5);
  for (const Model* model : {&study.written, &study.system->model()}) {
    const auto value = [&](const char* muscle) -> const MusculotendonParameters<double>& {
      return model->muscles[model->muscle(muscle)].parameters.musculotendon;
    };
    EXPECT_DOUBLE_EQ(value("biceps_long").optimal_fiber_length, 0.15);
    EXPECT_DOUBLE_EQ(value("brachialis").max_isometric_force, 900.0);
  }
  ASSERT_EQ(study.changes.size(), 2u);
  EXPECT_EQ(study.changes[0].muscle, "biceps_long");
}

TEST(MuscleStudy, ErrorsNameFileLineKeyAndTheNearestValidName) {
  const std::string ramp = "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"90 deg\"\nduration = 0.2\n";
  expect_refusals({{kArm, "motion", "is missing"},
                   {kArm + "[motion]\nmethod = \"cmc\"\n", "s.toml:4: motion.method", "computed muscle control"},
                   {kArm + "[motion]\nduration = 0\n", "s.toml:4: motion.duration", "must be above 0"},
                   {kArm + "[motion]\naccuracy = 1\n", "s.toml:4: motion.accuracy", "1e-13 to 0.1"},
                   {kArm + "[motion]\nfile = \"x.mot\"\n", "s.toml:4: motion.file", "no use for"},
                   {kFollow + "interpolation = \"hold\"\n" + ramp, "s.toml:6: motion.interpolation", "there is none"},
                   {kFollow + ramp + "[motion.control]\nwindow = 1\n", "s.toml:11: motion.control.window",
                    "longer than the motion"},
                   {kFollow + ramp + "[motion.control]\nmin_control = 1\n", "s.toml:11", "at least 0 and below 1"},
                   {kFollow + ramp + "[motion.static_optimization]\nexponent = 1\n", "s.toml:11", "above 1"}});
}

}  // namespace
}  // namespace veridyn::muscle
