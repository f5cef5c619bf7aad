#include "veridyn/cueing/washout/tilt_washout.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/cueing/washout/pushed.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::cueing {
namespace {

using testing_support::pushed;

/// Pitch after so many seconds of a force forward [rad].
double pitch_after(double seconds, double force, const TiltDesign& design) {
  TiltWashout w(design);
  PlatformCommand command = w.reset(pushed(0.0));
  const long steps = std::lround(seconds / 0.005);
  for (long k = 0; k < steps; ++k) command = w.step(pushed(force), 0.005);
  return command.angle.y();
}

// Gravity stands for the force: g sin(pitch) = gain f once it lasts.
TEST(TiltWashout, LetsGravityStandForALastingForce) {
  TiltDesign design;
  EXPECT_NEAR(pitch_after(20.0, 1.0, design), std::asin(1.0 / kGravity), 1e-6);
  design.force_gain = {0.5, 1.0};
  EXPECT_NEAR(pitch_after(20.0, 1.0, design), std::asin(0.5 / kGravity), 1e-6);
}

// 1 m/s^2 is a tilt of 5.9 deg, which takes two seconds at 3 deg/s.
TEST(TiltWashout, TiltsNoFasterThanAllowed) {
  const TiltDesign design;
  TiltWashout w(design);
  double before = w.reset(pushed(0.0)).angle.y(), fastest = 0.0;
  for (int k = 0; k < 800; ++k) {
    const PlatformCommand command = w.step(pushed(1.0), 0.005);
    fastest = std::max(fastest, (command.angle.y() - before) / 0.005);
    EXPECT_LE(std::abs(command.rate.y()), design.tilt_rate * (1.0 + 1e-9));
    before = command.angle.y();
  }
  EXPECT_NEAR(fastest, design.tilt_rate, 1e-9);
  EXPECT_LT(pitch_after(1.0, 1.0, design), design.tilt_rate);
}

// The closed form of a critically damped low-pass of second order, where neither the arcsine nor the rate is seen.
TEST(TiltWashout, FollowsASmallForceAsItsLowPass) {
  TiltDesign design;
  design.tilt = 4.0;
  design.tilt_rate = 1.0;
  constexpr double kWeak = 1e-4;
  for (const double t : {0.1, 0.3, 1.0}) {
    const double expected = kWeak / kGravity * (1.0 - (1.0 + 4.0 * t) * std::exp(-4.0 * t));
    // The force is held over steps of 5 ms, which the filter sees half a step late at most.
    EXPECT_NEAR(pitch_after(t, kWeak, design), expected, 0.03 * kWeak / kGravity) << t;
  }
}

TEST(TiltWashout, DoesNothingBesidesTilting) {
  TiltWashout w{TiltDesign{}};
  w.reset(pushed(0.0));
  recording::MotionSample turning = pushed(1.0);
  turning.rate = Eigen::Vector3d(0.0, 0.0, 0.5);
  PlatformCommand command;
  for (int k = 0; k < 200; ++k) command = w.step(turning, 0.01);
  EXPECT_EQ(command.angle.z(), 0.0);
  EXPECT_EQ(command.shift, Eigen::Vector3d::Zero());
}

TEST(TiltWashout, RefusesARateThatIsNone) {
  TiltDesign design;
  design.tilt_rate = 0.0;
  EXPECT_NE(why([&] { TiltWashout{design}; }).find("tilt_rate"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::cueing
