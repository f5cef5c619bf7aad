#include "veridyn/muscle/muscle_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/muscle/muscle_studies.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::muscle {
namespace {

using test::kArm;
using test::read_muscle_study;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(read_muscle_study(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::vector<double> excitations_at(const MuscleStudy& study, double time) {
  std::vector<double> u(study.controls.excitation.size());
  study.controls.excitation.evaluate(time, u.data());
  return u;
}

const std::string kFollow = kArm + "[motion]\nmethod = \"computed muscle control\"\nduration = 0.3\n";

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
  EXPECT_DOUBLE_EQ(study.written.bodies[static_cast<std::size_t>(forearm)].mass, 1.5);
  EXPECT_DOUBLE_EQ(study.system->model().bodies[static_cast<std::size_t>(forearm)].mass, 3.5);
  for (const Model* model : {&study.written, &study.system->model()}) {
    const auto value = [&](const char* muscle) -> const MusculotendonParameters<double>& {
      return model->muscles[static_cast<std::size_t>(model->muscle(muscle))].parameters.musculotendon;
    };
    EXPECT_DOUBLE_EQ(value("biceps_long").optimal_fiber_length, 0.15);
    EXPECT_DOUBLE_EQ(value("brachialis").max_isometric_force, 900.0);
  }
  ASSERT_EQ(study.changes.size(), 2u);
  EXPECT_EQ(study.changes[0].muscle, "biceps_long");
}

TEST(MuscleStudy, TakesFiberLengthsFromAReferenceBeforeItsOwnParameters) {
  const MuscleStudy study = read_muscle_study(
      kArm +
      "fiber_lengths_from = \"arm\"\n[subject.parameters]\n\"brachialis.optimal_fiber_length\" = 0.09\n"
      "[motion.excitation]\ndefault = 0.05\n");
  ASSERT_EQ(study.changes.size(), 13U);  // L0 and LS of six muscles from itself, and the study's own
  for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(study.changes[i].after / study.changes[i].before, 1.0, 1e-6);
  EXPECT_EQ(study.changes.back().after, 0.09);
  EXPECT_TRUE(study.warnings.empty());
  EXPECT_THAT(error_of(kArm + "fiber_lengths_from = \"arms\"\n[motion]\n"), HasSubstr("did you mean 'arm'"));
}

TEST(MuscleStudy, RampsAreTheFunctionsTheySay) {
  const MuscleStudy study = read_muscle_study(
      kFollow +
      "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"90 deg\"\nto = \"20 deg\"\nstart = 0.03\n"
      "duration = 0.1\nshape = \"half sine\"\n"
      "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"110 deg\"\nstart = 0.2\nduration = 0.05\n"
      "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"100 deg\"\nduration = 0.05\nshape = \"linear\"\n");
  const auto at = [&](double t) { return study.motion.coordinate[1]->evaluate(t); };
  const double q1 = 90.0 * kDegree, q2 = 20.0 * kDegree, rate = std::numbers::pi / 0.1;
  EXPECT_DOUBLE_EQ(at(0.0).value, q1);
  EXPECT_EQ(at(0.02).slope, 0.0);
  for (const double t : {0.03, 0.05, 0.0817, 0.12}) {
    // The closed form; quintics through its values, slopes and curvatures 64 to a ramp leave (pi/64)^6/46080 of the
    // rise, 3e-13 rad, and of a second derivative 4e4 times rate^2 pieces^2 less exactly.
    const double angle = rate * (t - 0.03) - std::numbers::pi / 2.0;
    EXPECT_NEAR(at(t).value, (q2 - q1) / 2.0 * std::sin(angle) + (q1 + q2) / 2.0, 1e-12);
    EXPECT_NEAR(at(t).slope, (q2 - q1) / 2.0 * rate * std::cos(angle), 1e-8);
    EXPECT_NEAR(at(t).curvature, -(q2 - q1) / 2.0 * rate * rate * std::sin(angle), 1e-3);
  }
  EXPECT_DOUBLE_EQ(at(0.15).value, q2);
  EXPECT_EQ(at(0.15).curvature, 0.0);
  // Half-way through a minimum-jerk ramp: half the rise, 15/8 of the mean speed, no acceleration.
  EXPECT_NEAR(at(0.225).value, 65.0 * kDegree, 1e-13);
  EXPECT_NEAR(at(0.225).slope, 1.875 * 90.0 * kDegree / 0.05, 1e-10);
  EXPECT_NEAR(at(0.225).curvature, 0.0, 1e-8);
  EXPECT_NEAR(at(0.26).value, 108.0 * kDegree, 1e-13);
  EXPECT_NEAR(at(0.26).slope, -10.0 * kDegree / 0.05, 1e-12);
  EXPECT_NEAR(at(0.31).value, 100.0 * kDegree, 1e-13);
  // The other coordinate rests at its default.
  EXPECT_EQ(study.motion.coordinate[0]->evaluate(0.2).value, 0.0);
  EXPECT_THAT(study.desired_coordinates, ElementsAre("elbow_flexion"));
}

TEST(MuscleStudy, ErrorsNameFileLineKeyAndTheNearestValidName) {
  const std::string ramp = "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"90 deg\"\nduration = 0.2\n";
  struct Case {
    std::string text, place, what;
  };
  const std::vector<Case> cases = {
      {"[subject]\nmodel = \"amr\"\n[motion]\n", "s.toml:2: subject.model", "did you mean 'arm'?"},
      {kArm, "motion", "is missing"},
      {kArm + "lcked = []\n[motion]\n", "s.toml:3: subject.lcked", "did you mean 'locked'?"},
      {kArm + "locked = [\"elbow\"]\n[motion]\n", "s.toml:3: subject.locked", "no coordinate 'elbow'"},
      {kArm + "locked = [\"elbow_flexion\", \"shoulder_flexion\"]\n[motion]\n", "s.toml:3: subject.locked",
       "no coordinate that could move"},
      {kArm + "paths = \"fit\"\n[motion]\n", "s.toml:3: subject.paths", "exact, fitted, opensim"},
      {kArm + "[subject.parameters]\n\"bicep_long.optimal_fiber_length\" = 0.1\n[motion]\n",
       "s.toml:4: subject.parameters.bicep_long.optimal_fiber_length", "did you mean 'biceps_long'?"},
      {kArm + "[subject.parameters]\n\"biceps_long.optimal_fibre_length\" = 0.1\n[motion]\n", "s.toml:4",
       "did you mean 'optimal_fiber_length'?"},
      {kArm + "[subject.parameters]\n\"biceps_long.optimal_fiber_length\" = 0\n[motion]\n", "s.toml:4", "must be > 0"},
      {kArm + "[subject.parameters]\n\"biceps_long.optimal_fiber_length\" = \"1 N\"\n[motion]\n", "s.toml:4",
       "expected a length [m]"},
      {kArm + "[[subject.load]]\nbody = \"hand\"\nmass = 1\n[motion]\n", "s.toml:4: subject.load[0].body",
       "no body of model 'arm'"},
      {kArm + "[[subject.load]]\nbody = \"forearm\"\nmass = nan\n[motion]\n", "s.toml:5", "finite"},
      {kArm + "[[subject.load]]\nbody = \"forearm\"\nmass = 1\nlocation = [1, 2]\n[motion]\n", "s.toml:6",
       "has 2 numbers"},
      {kArm + "[motion]\nmethod = \"cmc\"\n", "s.toml:4: motion.method", "computed muscle control"},
      {kArm + "[motion]\nduration = 0\n", "s.toml:4: motion.duration", "must be > 0"},
      {kArm + "[motion]\naccuracy = 1\n", "s.toml:4: motion.accuracy", "1e-13 to 0.1"},
      {kArm + "[motion.start]\nelbow = 1\n", "s.toml:4: motion.start.elbow", "no coordinate 'elbow'"},
      {kArm + "[motion.start]\nelbow_flexion = \"140 deg\"\n", "s.toml:4: motion.start.elbow_flexion",
       "is outside its range"},
      {kArm + "[motion.excitation]\nbrachialis = nan\n", "s.toml:4: motion.excitation.brachialis", "finite"},
      {kArm + "[motion.excitation]\nbrachialis = 1.2\n", "s.toml:4: motion.excitation.brachialis",
       "must be from 0 to 1"},
      {kArm + "[motion.excitation]\nbrachalis = 0.2\n", "s.toml:4: motion.excitation.brachalis",
       "did you mean 'brachialis'?"},
      {kArm + "[motion]\n[[motion.excitation_step]]\ntime = 0.2\nbrachialis = 0.1\n[[motion.excitation_step]]\n"
              "time = 0.1\n",
       "s.toml:8", "not after 0.2 s"},
      {kArm + "[motion]\nexcitation_file = \"nowhere.sto\"\n", "nowhere.sto", "no such file"},
      {kArm + "[motion]\nfile = \"x.mot\"\n", "s.toml:4: motion.file", "no use for"},
      {kFollow, "s.toml:3: motion", "needs a motion"},
      {kFollow + "interpolation = \"hold\"\n" + ramp, "s.toml:6: motion.interpolation", "has no meaning"},
      {kFollow + "[[motion.ramp]]\ncoordinate = \"elbow\"\nto = 1\nduration = 1\n",
       "s.toml:7: motion.ramp[0].coordinate", "no coordinate 'elbow'"},
      {kFollow + ramp + "shape = \"sine\"\n", "s.toml:10", "half sine"},
      {kFollow + ramp + "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"80 deg\"\nto = 1\nduration = 1\n",
       "s.toml:12", "jumps"},
      {kFollow + ramp + "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nstart = 0.1\nto = 1\nduration = 1\n",
       "s.toml:12", "before the end of the ramp before"},
      {kFollow + ramp + "[motion.control]\nwindow = 1\n", "s.toml:11: motion.control.window", "longer than the motion"},
      {kFollow + ramp + "[motion.control]\nmin_control = 1\n", "s.toml:11", "from 0 to below 1"},
      {kFollow + ramp + "[motion.static_optimization]\nexponent = 1\n", "s.toml:11", "above 1"},
      {"[subject]\nmodel = \"arm\"\nlocked = [\"elbow_flexion\"]\n[motion]\nmethod = \"computed muscle control\"\n" +
           ramp,
       "s.toml:7", "is locked and cannot follow"},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.text);
    EXPECT_THAT(error_of(c.text), AllOf(HasSubstr(c.place), HasSubstr(c.what)));
  }
}

}  // namespace
}  // namespace veridyn::muscle
