#include "veridyn/live/rig/car_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/live/rig/car_links_in_memory.hpp"

namespace veridyn::live {
namespace {

using test::CarRun;

TEST(CarLink, DrivesFromPedalToMotion) {
  CarRun r;
  r.run(6.0);
  EXPECT_EQ(r.links.car.actuation().state, CarState::kDriving);
  EXPECT_GT(r.links.car.state().vehicle(vehicle::kU), 1.5);
  const RigStatus& status = r.control.status();
  EXPECT_EQ(status.step.state, RigState::kRunning);
  EXPECT_EQ(r.links.platform.counts().outside, 0U);
  ASSERT_TRUE(status.car);
  EXPECT_TRUE(status.car->link.connected);
  EXPECT_EQ(status.car->link.commands_lost, 0U);
  EXPECT_EQ(status.car->link.reports_lost, 0U);
  EXPECT_EQ(status.car->state, CarState::kDriving);
  EXPECT_GT(status.car->battery, 5.0);
  EXPECT_GT(status.car->command.drive_force, 0.0);
  // The motion of the platform's rider is that of the car's sensors.
  const recording::MotionSample truth = r.links.car.motion();
  EXPECT_NEAR(status.step.motion->sample.rate.z(), truth.rate.z(), 0.15);
  EXPECT_NEAR(status.step.motion->sample.force.z(), kGravity, 0.5);
  // Wheel events and commands both come 100 times a second: one waits for the other for 10 ms at most.
  EXPECT_GT(r.loop.times().pedal_to_command.count(), 550U);
  EXPECT_LE(r.loop.times().pedal_to_command.largest(), 10 * kMillisecond);
}

TEST(CarLink, BrakesTheCarOnAnEmergencyAndUntilTheThrottleIsReleased) {
  CarRun r;
  r.run(3.0);
  ASSERT_GT(r.links.car.state().vehicle(vehicle::kU), 1.0);
  r.control.emergency();
  r.run(0.1);
  EXPECT_EQ(r.links.car.actuation().command.drive_force, 0.0);
  EXPECT_EQ(r.links.car.actuation().command.brake, 1.0);
  r.run(2.0);
  EXPECT_NEAR(r.links.car.state().vehicle(vehicle::kU), 0.0, 1e-2);
  r.control.request(OperatorRequest::kRelease);
  r.run(1.0);
  // The driver's foot is on the throttle still.
  EXPECT_EQ(r.links.car.actuation().command.brake, 0.0);
  EXPECT_EQ(r.links.car.actuation().command.drive_force, 0.0);
}

TEST(CarLink, BrakesTheCarWhereThePlatformIsLost) {
  CarRun r;
  r.run(3.0);
  r.links.platform_there = false;
  r.run(0.4);
  EXPECT_EQ(r.links.car.actuation().command.drive_force, 0.0);
  EXPECT_EQ(r.links.car.actuation().command.brake, 1.0);
}

TEST(CarLink, BrakesTheCarWhereItsDriverIsGone) {
  CarRun r(0.0, 3.0);
  r.run(2.9);
  EXPECT_GT(r.links.car.actuation().command.drive_force, 0.0);
  r.run(0.3);
  EXPECT_EQ(r.links.car.actuation().command.drive_force, 0.0);
  EXPECT_EQ(r.links.car.actuation().command.brake, 1.0);
}

TEST(CarLink, HoldsThePlatformWhereTheCarFallsSilent) {
  CarRun r;
  r.run(3.0);
  ASSERT_EQ(r.loop.rig().state(), RigState::kRunning);
  r.links.to_rig.cut = true;
  r.run(0.5);
  EXPECT_EQ(r.loop.rig().state(), RigState::kHold);
  EXPECT_EQ(r.loop.rig().readiness(), Readiness::kNoTelemetry);
  r.links.to_rig.cut = false;
  r.run(2.0);
  EXPECT_EQ(r.loop.rig().state(), RigState::kRunning);
}

TEST(CarLink, LosesWhatADamagedLineLosesAndDrivesOn) {
  CarRun r(0.01);
  r.run(20.0);
  const LinkQuality q = r.loop.rig().car()->quality(r.clock.now());
  // 1 - 0.99^28 and 1 - 0.99^53 are 24.5 and 41.3 %; 2000 frames know them to 1 and 1.1 %, four times of that.
  EXPECT_NEAR(q.command_loss(), 0.245, 0.04);
  EXPECT_NEAR(q.report_loss(), 0.413, 0.045);
  EXPECT_EQ(r.loop.rig().state(), RigState::kRunning);
  EXPECT_EQ(r.links.platform.counts().outside, 0U);
  EXPECT_EQ(r.links.car.end().verdicts()[CommandVerdict::kOutOfRange], 0U);
}

}  // namespace
}  // namespace veridyn::live
