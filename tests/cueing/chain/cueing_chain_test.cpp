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
    ASSERT_LT((s.reached.angle - s.desired.angle).norm(), 5e-4) << k;
    ASSERT_LT((s.reached.shift - s.desired.shift).norm(), 1e-4) << k;
  }
}

TEST(CueingChain, AnotherAlgorithmTakesOverWithoutAJump) {
  CueingChain chain(washout("classical"), built_in_platform("hexapod"));
  chain.reset(driving(0.0));
  CueingStep before, after;
  for (int k = 1; k < 700; ++k) before = chain.step(driving(0.01 * k), 0.01);
  EXPECT_GT(before.ordered.angle.norm(), 2.0 * kDegree);
  chain.take_over(washout("optimal"), driving(7.0));
  after = chain.step(driving(7.01), 0.01);
  const double went = (before.ordered.angle - chain.guard().state().angle).norm();
  EXPECT_LT(went, 0.2 * kDegree);
  EXPECT_LT((before.ordered.angle - after.desired.angle).norm(), 0.05 * kDegree);
  // The difference dies away: after five seconds it is the new algorithm alone.
  CueingChain alone(washout("optimal"), built_in_platform("hexapod"));
  alone.reset(driving(7.0));
  alone.step(driving(7.01), 0.01);
  for (int k = 702; k < 1300; ++k) {
    after = chain.step(driving(0.01 * k), 0.01);
    before = alone.step(driving(0.01 * k), 0.01);
  }
  EXPECT_LT((after.desired.angle - before.desired.angle).norm(), 1e-3 * kDegree);
}

/// A chain that has followed the drive for seven seconds.
CueingChain driven_chain() {
  CueingChain chain(washout("classical"), built_in_platform("hexapod"));
  chain.reset(driving(0.0));
  for (int k = 1; k < 700; ++k) chain.step(driving(0.01 * k), 0.01);
  return chain;
}

TEST(CueingChain, FollowsAShareOfItsAlgorithmAndLeadsToNeutralAtNone) {
  CueingChain whole = driven_chain(), half = driven_chain();
  CueingStep w, h;
  for (int k = 700; k < 1300; ++k) {
    w = whole.step(driving(0.01 * k), 0.01);
    h = half.step(driving(0.01 * k), 0.01, 0.5);
  }
  EXPECT_GT(w.ordered.angle.norm(), 1.0 * kDegree);
  EXPECT_LT((h.ordered.angle - 0.5 * w.ordered.angle).norm(), 1e-3 * kDegree);
  for (int k = 0; k < 500; ++k) h = half.hold(0.01, 0.0);
  EXPECT_LT(h.ordered.angle.norm(), 1e-6);
  EXPECT_LT(h.ordered.shift.norm(), 1e-6);
}

TEST(CueingChain, HoldsWhatItWasLastTold) {
  CueingChain chain = driven_chain();
  const CueingStep before = chain.step(driving(7.0), 0.01);
  CueingStep s;
  for (int k = 0; k < 100; ++k) s = chain.hold(0.01, 1.0);
  EXPECT_LT((s.ordered.angle - before.desired.angle).norm(), 1e-6);
  EXPECT_LT(s.ordered.rate.norm(), 1e-6);
}

TEST(CueingChain, BrakesToRestAsFastAsItsLimitsAllow) {
  CueingChain chain = driven_chain();
  const PlatformState at = chain.guard().state();
  const AxisState pitch = axis(at, PlatformAxis::kPitch);
  ASSERT_GT(std::abs(pitch.rate), 0.5 * kDegree);
  const AxisLimits& limits = built_in_platform("hexapod").limits[PlatformAxis::kPitch];
  CueingStep s;
  double time = 0.0;
  do {
    s = chain.brake(0.005);
    time += 0.005;
  } while (s.ordered.rate.norm() + s.ordered.velocity.norm() > 0.0 && time < 2.0);
  // From rate v and acceleration a: the jerk's way there and back, and the rate itself by the most acceleration.
  EXPECT_LT(time, 3.0 * limits.acceleration / limits.jerk + std::abs(pitch.rate) / limits.acceleration + 0.02);
  const PlatformState rest = chain.guard().state();
  chain.brake(0.1);
  EXPECT_EQ(chain.guard().state().angle, rest.angle);
}

TEST(CueingChain, BeginsAgainFromWhereThePlatformIs) {
  CueingChain chain = driven_chain();
  for (int k = 0; k < 50; ++k) chain.brake(0.01);
  const PlatformState rest = chain.guard().state();
  ASSERT_GT(rest.angle.norm(), 1.0 * kDegree);
  // With no share at first, as after an emergency stop: it stays, and then returns to its neutral pose gently.
  chain.restart(driving(20.0), 0.0);
  CueingStep s = chain.hold(0.01, 0.0);
  EXPECT_LT((s.desired.angle - rest.angle).norm(), 0.02 * kDegree);
  for (int k = 0; k < 800; ++k) s = chain.hold(0.01, 0.0);
  EXPECT_LT(s.ordered.angle.norm(), 1e-4);
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
  EXPECT_EQ(run.steps.back().ordered.shift.x(), 0.0);  // there is no surge
}

}  // namespace
}  // namespace veridyn::cueing
