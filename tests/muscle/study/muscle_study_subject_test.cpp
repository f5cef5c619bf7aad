// The subject of a muscle study: which model, changed in what.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/muscle/muscle_studies.hpp"

namespace veridyn::muscle {
namespace {

using test::expect_refusals;
using test::kArm;
using test::read_muscle_study;
using test::study_error;
using testing::HasSubstr;

TEST(MuscleStudy, TakesFiberLengthsFromAReferenceBeforeItsOwnParameters) {
  const MuscleStudy study = read_muscle_study(
      kArm +
      "fiber_lengths_from = \"arm\"\n[subject.parameters]\n\"brachialis.optimal_fiber_length\" = 0.09\n"
      "[motion.excitation]\ndefault = 0.05\n");
  ASSERT_EQ(study.changes.size(), 13U);  // L0 and LS of six muscles from itself, and the study's own
  for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(study.changes[i].after / study.changes[i].before, 1.0, 1e-6);
  EXPECT_EQ(study.changes.back().after, 0.09);
  EXPECT_TRUE(study.warnings.empty());
  EXPECT_THAT(study_error(kArm + "fiber_lengths_from = \"arms\"\n[motion]\n"), HasSubstr("did you mean 'arm'"));
}

TEST(MuscleStudySubject, ALoadIsInTheSystemsMassesOnly) {
  const MuscleStudy study = read_muscle_study(
      "title = \"lift\"\n" + kArm + "[[subject.load]]\nbody = \"forearm\"\nmass = 2\n[motion]\nduration = 0.1\n");
  EXPECT_EQ(study.title, "lift");
  const auto forearm = static_cast<std::size_t>(study.written.body("forearm"));
  EXPECT_DOUBLE_EQ(study.system->model().bodies[forearm].mass, study.written.bodies[forearm].mass + 2.0);
  ASSERT_EQ(study.loads.size(), 1U);
  EXPECT_EQ(study.loads[0].location, Eigen::Vector3d::Zero());
  EXPECT_EQ(read_muscle_study(kArm + "[motion]\n").title, study.system->model().name);
}

TEST(MuscleStudySubject, MistakesAreNamedWithFileLineAndKey) {
  expect_refusals(
      {{"[subject]\nmodel = \"amr\"\n[motion]\n", "s.toml:2: subject.model", "did you mean 'arm'?"},
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
        "has 2 numbers"}});
}

}  // namespace
}  // namespace veridyn::muscle
