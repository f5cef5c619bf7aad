#include "veridyn/cueing/washout/shared_channels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "veridyn/cueing/platform/platform_state.hpp"

namespace veridyn::cueing {
namespace {

/// A platform that stands where a command says.
PlatformState standing(const PlatformCommand& command) {
  PlatformState state;
  static_cast<PlatformCommand&>(state) = command;
  return state;
}

// Pairs are written as if the force pointed forward. What a pair does is felt as what it was to render, whichever pair
// it is: tilt as a force, shift as an acceleration.
TEST(PairedAxes, WhatTheyDoIsFeltAsWhatTheyAreToRender) {
  for (const Eigen::Index pair : {0, 1}) {
    PlatformCommand tilted;
    add_paired(tilted, {.tilt = 0.1}, pair);
    EXPECT_EQ(tilted.angle(pair), 0.1);
    const Eigen::Vector3d by_tilt = rider_motion(standing(tilted)).force;
    EXPECT_NEAR(paired_input(by_tilt, Eigen::Vector3d::Zero(), pair)(0), kGravity * std::sin(0.1), 1e-12) << pair;
    PlatformCommand shifted;
    add_paired(shifted, {.shift = 0.2, .acceleration = 1.5}, pair);
    EXPECT_EQ(std::abs(position(shifted, shift_axis(pair))), 0.2);
    const Eigen::Vector3d by_shift = rider_motion(standing(shifted)).force;
    EXPECT_NEAR(paired_input(by_shift, Eigen::Vector3d::Zero(), pair)(0), 1.5, 1e-12) << pair;
    EXPECT_NEAR(paired_input(Eigen::Vector3d::Zero(), by_shift, pair)(1), 1.5, 1e-12) << pair;
    // The pair moves its own two axes only.
    for (const PlatformAxis axis : kAllPlatformAxes) {
      if (axis != shift_axis(pair)) {
        EXPECT_EQ(position(shifted, axis), 0.0);
      }
      if (axis != tilt_axis(pair)) {
        EXPECT_EQ(position(tilted, axis), 0.0);
      }
    }
  }
}

// A vehicle that is pushed up and begins to turn about all its axes: the platform goes up, and turns the same way.
TEST(SharedChannels, BeginMotionsInTheirDirectionByTheirGains) {
  SharedKnobs knobs;
  knobs.force_gain[2] = 0.5;
  knobs.rate_gain = {0.2, 0.4, 0.6};
  SharedChannels channels(knobs);
  PlatformCommand begin;
  channels.add_to(begin, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), std::nullopt);
  EXPECT_EQ(begin.shift.norm() + begin.angle.norm(), 0.0);
  PlatformCommand command;
  const double h = 1e-3;
  channels.add_to(command, {0.0, 0.0, -2.0}, {0.1, -0.1, 0.1}, h);
  command = {};
  channels.add_to(command, {0.0, 0.0, -2.0}, {0.1, -0.1, 0.1}, h);
  // At the beginning filters let all of it through; heave counts upwards as the platform's command does.
  EXPECT_NEAR(std::abs(command.acceleration.z()), 0.5 * 2.0, 1e-2);
  EXPECT_NEAR(rider_motion(standing(command)).force.z() + kGravity, -0.5 * 2.0, 1e-2);
  EXPECT_LT((command.rate - Eigen::Vector3d(0.02, -0.04, 0.06)).norm(), 5e-4);
}

}  // namespace
}  // namespace veridyn::cueing
