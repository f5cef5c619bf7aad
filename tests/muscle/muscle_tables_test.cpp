// Tables of a muscle study's result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/muscle/muscle_studies.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/io/opensim/storage.hpp"
#include "veridyn/muscle/muscle_run.hpp"

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

}  // namespace
}  // namespace veridyn::muscle
