// Tables of a muscle study's result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/muscle/muscle_studies.hpp"
#include "veridyn/io/opensim/storage.hpp"
#include "veridyn/muscle/muscle_run.hpp"

namespace veridyn::muscle {
namespace {

class MuscleTables : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("veridyn_muscle_tables_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
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

}  // namespace
}  // namespace veridyn::muscle
