#include "veridyn/cueing/washout/washout_channels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"

namespace veridyn::cueing {
namespace {

// A lasting push through s^2/(s + w)^2: the shift goes to a/w^2 as a mass on a critically damped spring does, and its
// second derivative is felt.
TEST(ShiftChannel, AnswersAPushAsItsClosedForm) {
  const double w = 2.0, a = 1.5, h = 0.01;
  ShiftChannel channel(w, 1.0, 0.0);
  (void)channel.step(0.0, std::nullopt);
  // The push comes within the first step, on a line: half of it late.
  for (int k = 1; k <= 800; ++k) {
    const ChannelOutput o = channel.step(a, h);
    const double t = h * (k - 0.5), e = std::exp(-w * t);
    EXPECT_NEAR(o.place, a / (w * w) * (1.0 - (1.0 + w * t) * e), 2e-5) << k;
    EXPECT_NEAR(o.change, a * (1.0 - w * t) * e, 2e-4) << k;
  }
}

TEST(ShiftChannel, ComesBackFromAPushWithoutAnEnd) {
  ShiftChannel channel(1.0, 1.0, 0.2);
  (void)channel.step(0.0, std::nullopt);
  ChannelOutput o;
  for (int k = 0; k < 10000; ++k) o = channel.step(3.0, 0.01);
  EXPECT_NEAR(o.place, 0.0, 1e-6);
}

// A turn at a lasting rate through s/(s + w)^2: the angle is t exp(-w t) per rad/s.
TEST(TurnChannel, AnswersATurnAsItsClosedForm) {
  const double w = 1.5, h = 0.01;
  TurnChannel channel(w, 1.0);
  (void)channel.step(0.0, std::nullopt);
  for (int k = 1; k <= 500; ++k) {
    const ChannelOutput o = channel.step(0.4, h);
    const double t = h * (k - 0.5);
    EXPECT_NEAR(o.place, 0.4 * t * std::exp(-w * t), 2e-5) << k;
  }
}

TEST(TiltCoordination, LetsGravityStandForTheForceNoFasterThanAllowed) {
  const double force = 3.0, most = 0.05, h = 0.01, to = std::asin(force / kGravity);
  TiltCoordination tilt;
  (void)tilt.step(force, most, std::nullopt);
  EXPECT_EQ(tilt.tilt(), 0.0) << "it begins level";
  double time = 0.0;
  for (; tilt.tilt() < to - 1e-12; time += h) {
    const ChannelOutput o = tilt.step(force, most, h);
    ASSERT_LE(o.change, most + 1e-12);
    ASSERT_LT(time, 60.0);
  }
  EXPECT_NEAR(time, to / most, h);
  EXPECT_DOUBLE_EQ(kGravity * std::sin(tilt.tilt()), force);
  EXPECT_NEAR(tilt.step(force, most, h).change, 0.0, 1e-12);
  // Beyond gravity nothing stands for a force.
  for (int k = 0; k < 10000; ++k) (void)tilt.step(-50.0, most, h);
  EXPECT_DOUBLE_EQ(tilt.tilt(), -kPi / 2.0);
}

// x' = -x + u with u on a line: the exact solution over one long step, which is cut into pieces.
TEST(Integrated, FollowsInputsThatGoOnALine) {
  const auto rate = [](double x, double u) { return u - x; };
  const double step = 0.2, before = 1.0, now = 3.0, slope = (now - before) / step;
  const double exact = (0.5 - (before - slope)) * std::exp(-step) + before - slope + slope * step;
  EXPECT_NEAR(integrated(0.5, before, now, step, rate), exact, 1e-10);  // pieces of 5 ms, of fourth order
  EXPECT_EQ(integrated(0.5, before, now, 0.0, rate), 0.5);
}

}  // namespace
}  // namespace veridyn::cueing
