#include "veridyn/cueing/chain/cueing_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {
namespace {

recording::MotionSample driving(double t) {
  recording::MotionSample s;
  s.time = t;
  s.frame = Frame::kFrd;
  s.force =
      recording::force_at_rest(Frame::kFrd) + Eigen::Vector3d(2.0 * std::sin(0.8 * t), 3.0 * std::sin(0.5 * t), 0.0);
  s.rate = {0.0, 0.0, 0.2 * std::sin(0.5 * t)};
  return s;
}

std::unique_ptr<Washout> washout(const char* name) {
  return washout_algorithm(name).design()->make(built_in_platform("hexapod"));
}

TEST(CueingChain, OnTheIdealPlatformReachesWhatIsWanted) {
  const Platform& ideal = built_in_platform("ideal");
  CueingChain chain(washout("classical"), ideal);
  chain.reset(driving(0.0));
  for (int k = 1; k < 2000; ++k) {
    const CueingStep s = chain.step(driving(0.01 * k), 0.01);
    // Where the tilt begins to turn, at 3 deg/s at once, the guard rounds the corner off.
    ASSERT_LT((s.reached.angle - s.wanted.angle).norm(), 5e-4) << k;
    ASSERT_LT((s.reached.shift - s.wanted.shift).norm(), 1e-4) << k;
  }
}

TEST(CueingChain, AnotherAlgorithmTakesOverWithoutAJump) {
  CueingChain chain(washout("classical"), built_in_platform("hexapod"));
  chain.reset(driving(0.0));
  CueingStep before, after;
  for (int k = 1; k < 700; ++k) before = chain.step(driving(0.01 * k), 0.01);
  EXPECT_GT(before.told.angle.norm(), 2.0 * kDegree);
  chain.take_over(washout("optimal"), driving(7.0));
  after = chain.step(driving(7.01), 0.01);
  const double went = (before.told.angle - chain.guard().state().angle).norm();
  EXPECT_LT(went, 0.2 * kDegree);
  EXPECT_LT((before.told.angle - after.wanted.angle).norm(), 0.05 * kDegree);
  // The difference dies away: after five seconds it is the new algorithm alone.
  CueingChain alone(washout("optimal"), built_in_platform("hexapod"));
  alone.reset(driving(7.0));
  alone.step(driving(7.01), 0.01);
  for (int k = 702; k < 1300; ++k) {
    after = chain.step(driving(0.01 * k), 0.01);
    before = alone.step(driving(0.01 * k), 0.01);
  }
  EXPECT_LT((after.wanted.angle - before.wanted.angle).norm(), 1e-3 * kDegree);
}

TEST(CueingChain, ACopyGoesOnAlike) {
  CueingChain chain(washout("adaptive"), built_in_platform("hexapod"));
  chain.reset(driving(0.0));
  for (int k = 1; k < 300; ++k) chain.step(driving(0.01 * k), 0.01);
  CueingChain copy(chain);
  for (int k = 300; k < 600; ++k) {
    const CueingStep a = chain.step(driving(0.01 * k), 0.01), b = copy.step(driving(0.01 * k), 0.01);
    ASSERT_EQ(a.reached.angle, b.reached.angle);
    ASSERT_EQ(a.reached.shift, b.reached.shift);
  }
}

TEST(DrivePlatform, GivesAStepForEverySample) {
  std::vector<recording::MotionSample> drive;
  for (int k = 0; k < 1500; ++k) drive.push_back(driving(0.016 * k));
  Progress progress;
  const CueingRun run = drive_platform(drive, *washout("classical"), built_in_platform("three_axis"), progress);
  ASSERT_EQ(run.steps.size(), drive.size());
  ASSERT_EQ(run.rider.size(), drive.size());
  EXPECT_EQ(run.rider.back().time, drive.back().time);
  EXPECT_EQ(run.steps.back().told.shift.x(), 0.0);  // there is no surge
}

}  // namespace
}  // namespace veridyn::cueing
