#include "veridyn/cueing/platform/platform_state.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::cueing {
namespace {

using Vector = Eigen::Vector3d;

/// A motion along and about all axes, with its derivatives.
PlatformState at(double t) {
  PlatformState s;
  const Vector shift(0.1, -0.2, 0.15), omega(2.0, 3.0, 1.5), angle(0.3, -0.25, 0.4), nu(1.7, 2.3, 0.9);
  for (int i = 0; i < 3; ++i) {
    s.shift(i) = shift(i) * std::sin(omega(i) * t + 0.3);
    s.velocity(i) = shift(i) * omega(i) * std::cos(omega(i) * t + 0.3);
    s.acceleration(i) = -shift(i) * omega(i) * omega(i) * std::sin(omega(i) * t + 0.3);
    s.angle(i) = angle(i) * std::sin(nu(i) * t + 0.7);
    s.rate(i) = angle(i) * nu(i) * std::cos(nu(i) * t + 0.7);
    s.angular_acceleration(i) = -angle(i) * nu(i) * nu(i) * std::sin(nu(i) * t + 0.7);
  }
  return s;
}

Eigen::Matrix3d body_to_world(const PlatformState& s) {
  return numerics::R_body_from_ned(s.angle(0), s.angle(1), s.angle(2)).transpose();
}

/// Where a place on the platform is: forward, right, down.
Vector in_world(double t, const Vector& place) {
  const PlatformState s = at(t);
  return Vector(s.shift.x(), s.shift.y(), -s.shift.z()) + body_to_world(s) * place;
}

TEST(RiderMotion, IsThatOfThePlaceInTheWorldDifferentiated) {
  const Vector place(0.2, -0.4, -0.9);
  for (const double t : {0.1, 1.3, 4.7}) {
    const double h = 1e-4;
    const recording::MotionSample felt = rider_motion(at(t), place);
    const Vector acceleration = (in_world(t + h, place) - 2.0 * in_world(t, place) + in_world(t - h, place)) / (h * h);
    const Vector force = body_to_world(at(t)).transpose() * (acceleration - Vector(0.0, 0.0, kGravity));
    EXPECT_LT((felt.force - force).norm(), 1e-6) << t;
    // R' = R [omega]
    const Eigen::Matrix3d spin =
        body_to_world(at(t)).transpose() * (body_to_world(at(t + h)) - body_to_world(at(t - h))) / (2.0 * h);
    EXPECT_LT((felt.rate - Vector(spin(2, 1), spin(0, 2), spin(1, 0))).norm(), 1e-7) << t;
    const Vector angular = (body_rate(at(t + h)) - body_rate(at(t - h))) / (2.0 * h);
    EXPECT_LT((felt.angular_acceleration - angular).norm(), 1e-7) << t;
  }
}

TEST(RiderMotion, OfAPlatformThatStandsTiltedIsGravity) {
  PlatformState s;
  s.angle = {10.0 * kDegree, 0.0, 0.0};
  // The right side down: the seat pushes from the right, to the left.
  EXPECT_NEAR(rider_motion(s).force.y(), -kGravity * std::sin(10.0 * kDegree), 1e-12);
  s.angle = {0.0, 10.0 * kDegree, 0.0};
  // The nose up: the back of the seat pushes forward.
  EXPECT_NEAR(rider_motion(s).force.x(), kGravity * std::sin(10.0 * kDegree), 1e-12);
}

TEST(PlatformState, GivesBackWhatIsSetAlongEachAxis) {
  PlatformState s;
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const double v = 1.0 + static_cast<double>(i);
    set_axis(s, static_cast<PlatformAxis>(i), {v, 10.0 * v, 100.0 * v});
  }
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const AxisState a = axis(s, static_cast<PlatformAxis>(i));
    EXPECT_EQ(a.position, 1.0 + static_cast<double>(i));
    EXPECT_EQ(a.rate, 10.0 * a.position);
    EXPECT_EQ(a.acceleration, 100.0 * a.position);
    EXPECT_EQ(position(s, static_cast<PlatformAxis>(i)), a.position);
  }
}

}  // namespace
}  // namespace veridyn::cueing
