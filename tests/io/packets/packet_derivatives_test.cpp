#include "veridyn/io/packets/packet_derivatives.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "veridyn/core/constants.hpp"

namespace veridyn::io {
namespace {

/// A packet that says time, place, velocity and attitude, and nothing else.
PacketMotion said_at(double time, const Eigen::Vector3d& velocity, const Eigen::Quaterniond& attitude) {
  PacketMotion m;
  m.time = time;
  m.position = time * velocity;
  m.velocity = velocity;
  m.attitude = attitude;
  m.acceleration = m.rate = Eigen::Vector3d::Constant(kNaN);
  return m;
}

const Eigen::Vector3d kTurn(0.3, -0.4, 0.9);

/// Ten packets about 10 ms apart, turning steadily.
std::vector<PacketMotion> turning(const auto& velocity) {
  std::vector<PacketMotion> motions;
  for (int k = 0; k < 10; ++k) {
    const double t = 0.01 * k + (k % 2 == 0 ? 0.002 : 0.0);
    motions.push_back(
        said_at(t, velocity(t), Eigen::Quaterniond(Eigen::AngleAxisd(kTurn.norm() * t, kTurn.normalized()))));
  }
  return motions;
}

// Velocities on a line over uneven stamps have its slope, told in the axes of the body.
TEST(PacketDerivatives, AccelerationIsTheSlopeOfTheVelocityInBodyAxes) {
  const Eigen::Vector3d a(2.0, -1.0, 0.5);
  const auto motions = turning([&](double t) -> Eigen::Vector3d { return Eigen::Vector3d(10.0, 0.0, 0.0) + a * t; });
  for (const std::size_t k : {0U, 5U, 9U}) {
    const DerivedMotion d = with_derivatives(motions, k);
    EXPECT_TRUE(d.acceleration.all());
    EXPECT_LT((motions[k].attitude * d.motion.acceleration - a).norm(), 1e-9) << k;
  }
}

TEST(PacketDerivatives, RateIsThatOfTheTurningAttitude) {
  const auto motions = turning([](double) -> Eigen::Vector3d { return Eigen::Vector3d::UnitX(); });
  const DerivedMotion d = with_derivatives(motions, 5);
  EXPECT_TRUE(d.rate);
  // A line over 0.1 s of a turn of 1 rad/s falls short by (w T)^2/40 or so.
  EXPECT_LT((d.motion.rate - kTurn).norm(), 2e-3);
}

// Of a packet that has only just come in the derivative is that of half a window before.
TEST(PacketDerivatives, WithoutPacketsAfterItIsHalfAWindowLate) {
  std::vector<PacketMotion> motions;
  for (int k = 0; k < 9; ++k) {
    const double t = 0.0125 * k;
    motions.push_back(said_at(t, {4.0 * t * t, 0.0, 0.0}, Eigen::Quaterniond::Identity()));
  }
  const double at = motions[8].time;
  EXPECT_NEAR(with_derivatives(motions, 8, {.before = 0.05, .after = 0.0}).motion.acceleration.x(), 8.0 * (at - 0.025),
              1e-9);
}

TEST(PacketDerivatives, KeepsWhatThePacketSays) {
  auto motions = turning([](double t) -> Eigen::Vector3d { return {3.0 * t, 0.0, 0.0}; });
  motions[5].acceleration.y() = 7.0;
  motions[5].rate = Eigen::Vector3d(1.0, 2.0, 3.0);
  const DerivedMotion d = with_derivatives(motions, 5);
  EXPECT_EQ(d.motion.acceleration.y(), 7.0);
  EXPECT_TRUE(d.acceleration[0] && !d.acceleration[1] && d.acceleration[2]);
  EXPECT_EQ(d.motion.rate, motions[5].rate);
  EXPECT_FALSE(d.rate);
  // One packet alone has no slope.
  EXPECT_EQ(with_derivatives({&motions[4], 1}, 0).motion.acceleration.norm(), 0.0);
}

TEST(Follows, ALittleLaterAndWhereTheVelocityLeads) {
  const auto at = [](double time, double x) {
    PacketMotion m = said_at(time, {20.0, 0.0, 0.0}, Eigen::Quaterniond::Identity());
    m.position.x() = x;
    return m;
  };
  const PacketMotion before = at(1.0, 0.0);
  EXPECT_TRUE(follows(before, at(1.1, 2.0)));
  EXPECT_FALSE(follows(before, at(1.1, 30.0))) << "put back on the track";
  EXPECT_FALSE(follows(before, at(1.0, 0.0))) << "the same moment";
  EXPECT_FALSE(follows(before, at(0.9, -2.0)));
  EXPECT_FALSE(follows(before, at(2.5, 30.0))) << "a pause";
  PacketMotion nowhere = at(1.1, kNaN);
  EXPECT_TRUE(follows(before, nowhere)) << "a packet without places";
}

}  // namespace
}  // namespace veridyn::io
