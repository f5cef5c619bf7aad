#include "veridyn/muscle/study/muscle_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/muscle/muscle_studies.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

TEST(MuscleRun, InverseDynamicsOfRestIsWhatHoldsTheWeight) {
  const MuscleStudy study =
      test::read_muscle_study(test::kArm +
                              "[[subject.load]]\nbody = \"forearm\"\nmass = 1\nlocation = [0, -0.3, 0]\n[motion]\n"
                              "method = \"inverse dynamics\"\nduration = 0.1\n[[motion.ramp]]\n"
                              "coordinate = \"elbow_flexion\"\nfrom = \"90 deg\"\nto = \"90 deg\"\nduration = 0.1\n");
  Progress progress;
  const MuscleResult result = run_study(study, progress);
  ASSERT_EQ(result.trajectory.time.size(), 21u);
  // The forearm is level: 1.5 kg at 0.17 m and 1 kg at 0.3 m from the elbow.
  EXPECT_NEAR(result.generalized_force(7, 1), (1.5 * 0.17 + 0.3) * kGravity, 1e-12);
}

TEST(MuscleRun, StaticOptimizationBalancesTheMotion) {
  const MuscleStudy study = test::read_muscle_study(
      test::kArm +
      "locked = [\"shoulder_flexion\"]\n[motion]\nmethod = \"static optimization\"\nduration = 0.5\n"
      "rate = 40\n[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"20 deg\"\nto = \"100 deg\"\n"
      "duration = 0.5\n");
  Progress progress;
  const MuscleResult result = run_study(study, progress);
  const MuscleTrajectory& t = result.trajectory;
  ASSERT_EQ(t.time.size(), 21u);
  EXPECT_TRUE(result.warnings.empty());
  // Moment arms by differences of the path lengths over the rows, forces times them: the moment that was required.
  const Eigen::Index i = 10;
  double moment = t.reserve(i, 1);
  for (Eigen::Index m = 0; m < t.tendon_force.cols(); ++m) {
    const double arm = -(t.path_length(i + 1, m) - t.path_length(i - 1, m)) / (t.q(i + 1, 1) - t.q(i - 1, 1));
    moment += t.tendon_force(i, m) * arm;
  }
  // Central differences over 0.1 rad of arms of 3 cm: a part in a few hundred.
  EXPECT_NEAR(moment, result.generalized_force(i, 1), 0.02 * std::abs(result.generalized_force(i, 1)));
  EXPECT_GE(t.activation.minCoeff(), 0.01 - 1e-9);
}

TEST(MuscleRun, SaysWhenASimulationLeavesARange) {
  const MuscleStudy study =
      test::read_muscle_study(test::kArm +
                              "locked = [\"shoulder_flexion\"]\n[motion]\nduration = 0.2\n[motion.start]\n"
                              "elbow_flexion = \"120 deg\"\n[motion.start_speed]\nelbow_flexion = \"1000 deg/s\"\n");
  Progress progress;
  const MuscleResult result = run_study(study, progress);
  // Far beyond the range, at 159 deg, the triceps' insertion comes round to the other side of the elbow's cylinder.
  EXPECT_THAT(result.warnings,
              testing::ElementsAre(testing::HasSubstr("'elbow_flexion' leaves its range 0 .. 130 deg at 0.0"),
                                   testing::HasSubstr("muscle 'triceps_long' changes the side of a wrap object"),
                                   testing::HasSubstr("muscle 'triceps_lateral' changes the side of a wrap object"),
                                   testing::HasSubstr("muscle 'triceps_medial' changes the side of a wrap object")));
}

class MuscleRunFiles : public testing::Test {
 protected:
  veridyn::test::TemporaryFolder scratch_;
  std::filesystem::path folder_ = scratch_.path();
};

// The example's leg: muscles that are functions of coordinates, a knee that slides with flexion and varus.
TEST_F(MuscleRunFiles, StaticOptimizationFindsTheActivationsOfMusclesByFunctions) {
  const std::filesystem::path examples = veridyn::test::source_folder() / "examples/studies/muscle";
  const std::string leg = "[subject]\nmodel = \"leg_by_functions.osim\"\n[motion]\n";
  const std::string forward = "duration = 0.1\njoint_reactions = \"ground\"\n[motion.excitation]\ndefault = 0.02\n";
  Progress progress;
  const MuscleResult moved =
      run_study(test::read_muscle_study(leg + forward + "vasti = 0.06\nrectus_femoris = 0.05\n", examples), progress);
  EXPECT_THAT(moved.warnings,
              testing::ElementsAre(testing::HasSubstr(
                  "joint reactions lack what 3 of the paths (vasti, rectus_femoris, hamstrings) press")));
  const MuscleTrajectory& t = moved.trajectory;
  std::ofstream table(folder_ / "motion.csv");
  table << "time,hip_flexion,knee_flexion,knee_varus\n";
  for (std::size_t i = 0; i < t.time.size(); ++i)
    table << fmt::format("{},{}\n", t.time[i], fmt::join(t.q.row(static_cast<Eigen::Index>(i)), ","));
  table.close();
  const MuscleResult found = run_study(
      test::read_muscle_study(
          leg + fmt::format("method = \"static optimization\"\nfile = \"{}\"\n", (folder_ / "motion.csv").string()),
          examples),
      progress);
  ASSERT_EQ(found.trajectory.activation.rows(), t.activation.rows());
  // Tendons are rigid for one and not for the other; both ends of a spline have no good second derivatives.
  const Eigen::Index inner = t.activation.rows() - 6;
  EXPECT_LT((found.trajectory.activation - t.activation).middleRows(3, inner).cwiseAbs().maxCoeff(), 0.005);
  const MuscleResult kicked = run_study(
      test::read_muscle_study(leg + forward + "[motion.start_speed]\nhip_flexion = \"-1000 deg/s\"\n", examples),
      progress);
  EXPECT_THAT(kicked.warnings,
              testing::Contains(
                  testing::AllOf(testing::HasSubstr("'hip_flexion' leaves its range"),
                                 testing::HasSubstr("the model's functions of paths are extrapolated from there on"))));
}

TEST_F(MuscleRunFiles, AForwardStudyReplaysWhatComputedMuscleControlFound) {
  const std::string load = "[[subject.load]]\nbody = \"forearm\"\nmass = 1\nlocation = [0, -0.3, 0]\n";
  const MuscleStudy follow =
      test::read_muscle_study(test::kArm + load +
                              "[motion]\nmethod = \"computed muscle control\"\nbegin = 0.1\nduration = 0.2\n"
                              "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"30 deg\"\nto = \"50 deg\"\n"
                              "duration = 0.2\n");
  Progress progress;
  const MuscleResult found = run_study(follow, progress);
  ASSERT_TRUE(found.usable());
  EXPECT_LT(found.tracking_error(1), 0.5 * kDegree);
  io::write_storage(state_storage(follow, found), folder_ / "states.sto");
  io::write_storage(control_storage(follow, found).value(), folder_ / "controls.sto");
  const std::string forward = test::kArm + load +
                              "[motion]\nbegin = 0.1\nduration = 0.2\nstart_file = \"states.sto\"\n"
                              "excitation_file = \"controls.sto\"\ninterpolation = ";
  const MuscleResult held = run_study(test::read_muscle_study(forward + "\"hold\"\n", folder_), progress);
  ASSERT_EQ(held.trajectory.q.rows(), found.trajectory.q.rows());
  EXPECT_LT((held.trajectory.q - found.trajectory.q).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((held.trajectory.tendon_force - found.trajectory.tendon_force).cwiseAbs().maxCoeff(), 1e-5);
  // From the middle on: fibres are not in equilibrium there, so their lengths must come from the file too. The first
  // step is another, so that the integration's accuracy is what is left (1e-2 when fibres start in equilibrium).
  std::string later = forward + "\"hold\"\n";
  const std::string whole = "begin = 0.1\nduration = 0.2\n";
  later.replace(later.find(whole), whole.size(), "begin = 0.2\nduration = 0.1\n");
  const MuscleResult half = run_study(test::read_muscle_study(later, folder_), progress);
  EXPECT_LT((half.trajectory.q - found.trajectory.q.bottomRows(21)).cwiseAbs().maxCoeff(), 1e-5);
  // Both ends of every window are written, so that a program that interpolates has the same controls: what differs is
  // how the integrator comes over the jumps, less and less with its accuracy.
  const std::string finely = "accuracy = 1e-9\n";
  const MuscleResult exact = run_study(test::read_muscle_study(forward + "\"hold\"\n" + finely, folder_), progress);
  const MuscleResult interpolated =
      run_study(test::read_muscle_study(forward + "\"linear\"\n" + finely, folder_), progress);
  EXPECT_LT((interpolated.trajectory.q - exact.trajectory.q).cwiseAbs().maxCoeff(), 1e-6);
  // The states are part of it: from rest it is another motion.
  std::string rest = forward + "\"hold\"\n[motion.start]\nelbow_flexion = \"30 deg\"\n";
  const std::string start = "start_file = \"states.sto\"\n";
  rest.replace(rest.find(start), start.size(), "");
  const MuscleResult other = run_study(test::read_muscle_study(rest, folder_), progress);
  EXPECT_GT((other.trajectory.q - found.trajectory.q).cwiseAbs().maxCoeff(), 1e-4);
}

}  // namespace
}  // namespace veridyn::muscle
