// Tables of a muscle study's result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/muscle/muscle_studies.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/io/opensim/storage.hpp"
#include "veridyn/muscle/study/muscle_run.hpp"

namespace veridyn::muscle {
namespace {

class MuscleTables : public testing::Test {
 protected:
  veridyn::test::TemporaryFolder scratch_;
  std::filesystem::path folder_ = scratch_.path();
};

TEST_F(MuscleTables, TablesReadBackAsTheMotionTheyAre) {
  const MuscleStudy study =
      test::read_muscle_study(test::kArm + "[motion]\nduration = 0.1\n[motion.start]\nelbow_flexion = 0.5\n");
  Progress progress;
  const MuscleResult result = run_study(study, progress);
  io::write_storage(state_storage(study, result), folder_ / "states.sto");
  const SignalTable table = read_signals(folder_ / "states.sto");
  EXPECT_THAT(table.names,
              testing::IsSupersetOf({"/jointset/elbow/elbow_flexion/value", "/jointset/shoulder/shoulder_flexion/speed",
                                     "/forceset/brachialis/activation", "/forceset/brachialis/fiber_length"}));
  const MuscleStudy inverse =
      test::read_muscle_study(test::kArm + "[motion]\nmethod = \"inverse dynamics\"\nfile = \"states.sto\"\n", folder_);
  EXPECT_EQ(inverse.begin, 0.0);
  EXPECT_DOUBLE_EQ(inverse.end, 0.1);
  EXPECT_NEAR(inverse.motion.coordinate[1]->evaluate(0.05).value, result.trajectory.q(10, 1), 1e-12);
  EXPECT_THAT(motion_table(study, result).names(), testing::ElementsAre("shoulder_flexion", "shoulder_flexion_speed",
                                                                        "elbow_flexion", "elbow_flexion_speed"));
  EXPECT_EQ(muscle_table(study, result).names().size(), 5u * 6u);
}

TEST_F(MuscleTables, CostAndContributionsAreWrittenWhereTheStudyAsksForThem) {
  const std::string motion =
      "[motion]\nduration = 0.05\naccuracy = 1e-8\nmetabolic_cost = \"bhargava\"\ninduced_accelerations = true\n";
  const MuscleStudy study = test::read_muscle_study(test::kArm + motion + "[motion.slow_twitch]\nbrachialis = 0.8\n");
  ASSERT_TRUE(study.metabolic);
  EXPECT_EQ(study.metabolic->model, MetabolicModel::kBhargava2004);
  EXPECT_EQ(study.metabolic->slow_twitch[study.system->model().muscle("brachialis")], 0.8);
  EXPECT_EQ(study.metabolic->slow_twitch[0], study.system->model().muscle("brachialis") == 0 ? 0.8 : 0.5);
  Progress progress;
  const MuscleResult result = run_study(study, progress);
  const Recording cost = metabolic_table(study, result);
  ASSERT_EQ(cost.names().size(), 8u);
  EXPECT_THAT(cost.names(), testing::IsSupersetOf({"brachialis_power", "basal_power", "total_power"}));
  EXPECT_THAT(result.notes, testing::Contains(testing::HasSubstr("metabolic cost: ")));
  const Recording parts = induced_table(study, result);
  EXPECT_THAT(parts.names(), testing::IsSupersetOf({"elbow_flexion_by_brachialis", "elbow_flexion_by_gravity",
                                                    "shoulder_flexion_by_velocity"}));
  // Parts of the elbow's acceleration add up to the change of its speed.
  const std::size_t row = 5;
  double sum = 0.0;
  for (const Eigen::Index c : {0, 1})
    if (study.system->model().coordinates[result.induced->coordinates[c]].name == "elbow_flexion")
      sum = result.induced->part[c].row(row).sum();
  const Eigen::Index elbow = study.system->model().coordinate("elbow_flexion");
  const double change = (result.trajectory.qdot(row + 1, elbow) - result.trajectory.qdot(row - 1, elbow)) * 100.0;
  EXPECT_NEAR(sum, change, 0.02 * std::abs(change));
  const MuscleStudy plain = test::read_muscle_study(test::kArm + "[motion]\nduration = 0.05\n");
  EXPECT_FALSE(plain.metabolic);
  EXPECT_FALSE(run_study(plain, progress).induced);
  test::expect_refusals(
      {{test::kArm + motion + "[motion.slow_twitch]\nbrachialis = 1.2\n", "slow_twitch.brachialis",
        "must be from 0 to 1"},
       {test::kArm + motion + "[motion.slow_twitch]\nbrachiali = 0.2\n", "brachiali", "did you mean 'brachialis'?"},
       {test::kArm + "[motion]\nmetabolic_cost = \"hill\"\n", "metabolic_cost", "umberger"}});
}

}  // namespace
}  // namespace veridyn::muscle
