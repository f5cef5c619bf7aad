#include "veridyn/recording/motion_sample.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::recording {
namespace {

MotionSample some_motion() {
  MotionSample s;
  s.frame = Frame::kFrd;
  s.place = {0.1, 0.2, -0.3};
  s.force = {1.0, -2.0, -8.0};
  s.rate = {0.3, -0.2, 0.5};
  s.angular_acceleration = {-1.0, 0.4, 0.2};
  s.attitude = numerics::quaternion_from_euler(0.3, -0.2, 1.1);
  s.position = {30.0, -4.0};
  s.position_from = Origin::kMeasured;
  return s;
}

TEST(MotionSample, AtRestItFeelsOneGravityUpWhateverItsAttitude) {
  EXPECT_EQ(force_at_rest(Frame::kFrd).z(), -kGravity);
  EXPECT_EQ(force_at_rest(Frame::kFlu).z(), kGravity);
  MotionSample s;
  s.frame = Frame::kFrd;
  // Nose up by 30 deg: f = -R' g, along x +g sin(theta).
  s.attitude = numerics::quaternion_from_euler(0.0, kPi / 6.0, 0.7);
  s.force = {0.5 * kGravity, 0.0, -std::cos(kPi / 6.0) * kGravity};
  EXPECT_LT(acceleration(s).norm(), 1e-14);
  EXPECT_LT(acceleration(in_frame(s, Frame::kFlu)).norm(), 1e-14);
}

TEST(MotionSample, ThereAndBackBetweenFramesIsTheSame) {
  const MotionSample frd = some_motion(), flu = in_frame(frd, Frame::kFlu), back = in_frame(flu, Frame::kFrd);
  EXPECT_EQ(flu.force, Eigen::Vector3d(1.0, 2.0, 8.0));
  EXPECT_EQ(back.force, frd.force);
  EXPECT_EQ(back.attitude.coeffs(), frd.attitude.coeffs());
  EXPECT_EQ(back.place, frd.place);
  EXPECT_EQ(flu.position, Eigen::Vector2d(30.0, 4.0));
  EXPECT_EQ(back.position, frd.position);
  // The same physics in either: turned body axes of the acceleration.
  const Eigen::Vector3d a = acceleration(frd), b = acceleration(flu);
  EXPECT_LT((b - Eigen::Vector3d(a.x(), -a.y(), -a.z())).norm(), 1e-14);
}

TEST(MotionSample, AtAnotherPlaceItIsThatOfTheRigidBody) {
  // A place on a body that turns: second derivative of R(t) d by central differences.
  const MotionSample s = some_motion();
  const Eigen::Vector3d place(1.2, -0.4, 0.6), d = place - s.place;
  const auto turned_by = [&](double t) {
    const Eigen::Vector3d angle = s.rate * t + 0.5 * s.angular_acceleration * t * t;
    // To second order in t the rotation of a rate that changes evenly is that of its mean.
    return Eigen::AngleAxisd(angle.norm(), angle.normalized()) * d;
  };
  constexpr double kStep = 1e-4;
  const Eigen::Vector3d lever = (turned_by(kStep) - 2.0 * d + turned_by(-kStep)) / (kStep * kStep);
  EXPECT_LT((at_place(s, place).force - s.force - lever).norm(), 1e-5);
  EXPECT_LT((at_place(at_place(s, place), s.place).force - s.force).norm(), 1e-14);
  const Eigen::Vector2d moved = (s.attitude.toRotationMatrix() * d).head<2>();
  EXPECT_LT((at_place(s, place).position - s.position - moved).norm(), 1e-14);
  EXPECT_LT(
      (in_frame(at_place(s, place), Frame::kFlu).force - at_place(in_frame(s, Frame::kFlu), {1.2, 0.4, -0.6}).force)
          .norm(),
      1e-14);
}

}  // namespace
}  // namespace veridyn::recording
