#include "veridyn/vehicle/simulation/body_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle {
namespace {

/// A body that turns about all its axes at once.
BodyMotion turning_body(double t) {
  BodyMotion m;
  m.time = t;
  m.yaw = 0.8 * t + 0.3 * std::sin(t);
  m.yaw_rate = 0.8 + 0.3 * std::cos(t);
  m.yaw_acceleration = -0.3 * std::sin(t);
  m.pitch = 0.2 * std::sin(2.0 * t);
  m.pitch_rate = 0.4 * std::cos(2.0 * t);
  m.pitch_acceleration = -0.8 * std::sin(2.0 * t);
  m.roll = 0.3 * std::cos(1.5 * t);
  m.roll_rate = -0.45 * std::sin(1.5 * t);
  m.roll_acceleration = -0.675 * std::cos(1.5 * t);
  return m;
}

// Rates are those of the attitude, whose derivative knows nothing of the axes they were put together from.
TEST(BodyMotion, RatesAreThoseOfTheAttitude) {
  const double h = 1e-4;
  for (const double t : {0.3, 1.1, 2.6}) {
    const auto before = motion_sample(turning_body(t - h), kGravity),
               after = motion_sample(turning_body(t + h), kGravity);
    const auto now = motion_sample(turning_body(t), kGravity);
    const Eigen::AngleAxisd turned(before.attitude.conjugate() * after.attitude);
    EXPECT_LT((now.rate - turned.angle() * turned.axis() / (2.0 * h)).norm(), 1e-6);
    EXPECT_LT((now.angular_acceleration - (after.rate - before.rate) / (2.0 * h)).norm(), 1e-6);
  }
}

TEST(BodyMotion, ParkedOnAGradeFeelsGravityAlongTheRoad) {
  const double grade = 0.1;
  const auto parked = motion_sample(BodyMotion{}, kGravity, grade);
  EXPECT_NEAR(parked.force.x(), kGravity * std::sin(grade), 1e-12);
  EXPECT_NEAR(parked.force.z(), kGravity * std::cos(grade), 1e-12);
  // Against the world it does not accelerate, and it looks uphill.
  EXPECT_LT((parked.attitude * parked.force - Eigen::Vector3d(0.0, 0.0, kGravity)).norm(), 1e-12);
  EXPECT_NEAR((parked.attitude * Eigen::Vector3d::UnitX()).z(), std::sin(grade), 1e-12);
}

}  // namespace
}  // namespace veridyn::vehicle
