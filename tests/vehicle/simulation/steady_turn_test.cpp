#include "veridyn/vehicle/simulation/steady_turn.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::vehicle {
namespace {

using ::testing::Each;
using ::testing::IsEmpty;

/// Samples on circles of 50 m, to the left or right, ever faster: 4 mrad of steer beyond L/R per m/s^2, and roll.
VehicleTrajectory circle(double side) {
  VehicleTrajectory t;
  for (int k = 0; k < 40; ++k) {
    const double speed = 1.0 + 0.4 * k, r = side * speed / 50.0, a = speed * r;
    t.time.push_back(k);
    t.u.push_back(speed * std::cos(0.01));
    t.v.push_back(-side * speed * std::sin(0.01));
    t.r.push_back(r);
    t.steer.push_back(2.5 * side / 50.0 + 0.004 * a);
    t.roll.push_back(0.009 * a + 0.001 * side);
  }
  return t;
}

TEST(SteadyTurn, IsAlikeToBothSides) {
  const TurnSamples left = steady_turn(circle(1.0), 2.5), right = steady_turn(circle(-1.0), 2.5);
  ASSERT_EQ(left.acceleration.size(), 40U);
  EXPECT_EQ(left.acceleration, right.acceleration);
  EXPECT_EQ(left.extra_steer, right.extra_steer);
  EXPECT_EQ(left.roll, right.roll);
  EXPECT_NEAR(left.acceleration[10], 25.0 / 50.0, 1e-12);
  EXPECT_NEAR(left.extra_steer[10], 0.004 * 0.5, 1e-15);
  EXPECT_THAT(left.sideslip, Each(::testing::DoubleNear(-0.01, 1e-12))) << "the tail hangs out";
  EXPECT_THAT(right.sideslip, Each(::testing::DoubleNear(-0.01, 1e-12)));
}

TEST(SteadyTurn, LeavesOutWhatComesBeforeItsBeginAndRollThatTheModelHasNot) {
  VehicleTrajectory t = circle(1.0);
  EXPECT_EQ(steady_turn(t, 2.5, 30.0).acceleration.size(), 10U);
  EXPECT_THAT(steady_turn(t, 2.5, kInfinity).acceleration, IsEmpty());
  t.roll.clear();
  EXPECT_THAT(steady_turn(t, 2.5).roll, IsEmpty());
}

TEST(SteadyTurn, BeginsAfterTheWayOntoAGivenCircle) {
  Manoeuvre manoeuvre = slowly_increasing_steer(0.03, 0.001);
  EXPECT_EQ(steady_turn_begin(manoeuvre), 0.0);
  manoeuvre.radius = 40.0;
  manoeuvre.default_duration = 120.0;
  EXPECT_EQ(steady_turn_begin(manoeuvre), 18.0);
  EXPECT_EQ(steady_turn_begin(ramp_steer(0.05, 0.01)), 0.0);
  EXPECT_EQ(steady_turn_begin(step_steer(0.05)), kInfinity);
}

TEST(TurnGradient, IsTheSlopeWithinItsRange) {
  const TurnSamples turn = steady_turn(circle(1.0), 2.5);
  const TurnGradient roll = turn_gradient(turn.acceleration, turn.roll);
  EXPECT_NEAR(roll.slope, 0.009, 1e-15);
  EXPECT_NEAR(roll.intercept, 0.001, 1e-15);
  // What bends beyond the range does not count.
  std::vector<double> bent = turn.extra_steer;
  for (std::size_t i = 0; i < bent.size(); ++i)
    if (turn.acceleration[i] > 3.0) bent[i] += 1.0;
  EXPECT_NEAR(turn_gradient(turn.acceleration, bent, 0.5, 3.0).slope, 0.004, 1e-15);
  EXPECT_GT(turn_gradient(turn.acceleration, bent).slope, 0.1);
}

TEST(TurnGradient, IsNotANumberWithoutThreeDifferentSamples) {
  EXPECT_TRUE(std::isnan(turn_gradient(std::vector{1.0, 2.0}, std::vector{1.0, 2.0}).slope));
  EXPECT_TRUE(std::isnan(turn_gradient(std::vector{1.0, 1.0, 1.0}, std::vector{1.0, 2.0, 3.0}).slope));
  EXPECT_NEAR(turn_gradient(std::vector{1.0, 2.0, 3.0}, std::vector{1.0, 2.0, 3.0}).slope, 1.0, 1e-15);
}

}  // namespace
}  // namespace veridyn::vehicle
