#include "veridyn/live/page/felt_now.hpp"

#include <gtest/gtest.h>

#include "tests/live/weaving_drive.hpp"

namespace veridyn::live {
namespace {

TEST(FeltNow, IsWhatTheScoreSaysWasFelt) {
  const LiveStudy study = test::rig_study();
  const std::vector<recording::MotionSample> drive = test::weaving_drive(10.0);
  FeltNow felt(study.cueing);
  cueing::CueingRun run;
  for (std::size_t k = 0; k < drive.size(); k += 2) {  // 50 Hz
    RigStatus status;
    status.step.time = nanoseconds(drive[k].time);
    status.step.motion = EvenSample{.sample = drive[k]};
    felt.update(status);
    run.vehicle.push_back(recording::in_frame(drive[k], Frame::kFrd));
    run.rider.push_back(rider_motion(status.step.cueing.reached, study.cueing.platform.rider));
    run.rider.back().time = drive[k].time;
  }
  const cueing::FeltMotion whole =
      felt_motion(run, cueing::vestibular_model(study.cueing.perception), study.cueing.thresholds);
  ASSERT_TRUE(felt.now());
  for (std::size_t i = 0; i < cueing::kCues; ++i) {
    EXPECT_NEAR(felt.now()->vehicle[i], whole.felt[i].vehicle.back(), 1e-9) << i;
    EXPECT_NEAR(felt.now()->rider[i], whole.felt[i].platform.back(), 1e-9) << i;
    EXPECT_EQ(felt.threshold()[i], whole.threshold[i]) << i;
  }
  EXPECT_GT(std::abs(felt.now()->vehicle[cueing::Cue::kSway]), 0.1);
}

TEST(FeltNow, NothingIsFeltBeforeTheFirstMotionNorOfANervesFiringRate) {
  LiveStudy study = test::rig_study();
  RigStatus status;
  status.step.time = kSecond;
  FeltNow felt(study.cueing);
  felt.update(status);
  EXPECT_FALSE(felt.now());
  study.cueing.perception = "ormsby";
  FeltNow firing(study.cueing);
  status.step.motion.emplace();
  firing.update(status);
  EXPECT_FALSE(firing.now());
}

}  // namespace
}  // namespace veridyn::live
