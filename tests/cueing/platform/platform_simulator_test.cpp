#include "veridyn/cueing/platform/platform_simulator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "veridyn/cueing/platform/platform_guard.hpp"

namespace veridyn::cueing {
namespace {

TEST(DelayLine, GivesBackWhatWasAtIrregularSteps) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> step(0.001, 0.02);
  DelayLine line(0.037);
  line.reset(0.0);
  double t = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const double h = step(random);
    t += h;
    const double back = line.step(3.0 * t, h);
    EXPECT_NEAR(back, 3.0 * std::max(t - 0.037, 0.0), 1e-9);
  }
}

TEST(PlatformSimulator, FollowsASineAsASecondOrderSystemBehindADelay) {
  Platform p = built_in_platform("three_axis");
  p.legs.reset();
  p.actuators = {.omega = 25.0, .zeta = 0.8, .delay = 0.02};
  PlatformSimulator simulator(p);
  const double omega = 6.0, step = 0.002, size = 5.0 * kDegree;
  PlatformState ordered;
  simulator.reset(ordered);
  const std::complex<double> s(0.0, omega);
  const std::complex<double> gain = 625.0 / (s * s + 40.0 * s + 625.0) * std::exp(-s * 0.02);
  for (double t = step; t < 5.0; t += step) {
    ordered.angle.x() = size * std::sin(omega * t);
    const PlatformState is = simulator.step(ordered, step);
    if (t < 2.0) continue;
    const std::complex<double> wave = size * gain * std::exp(s * t);
    ASSERT_NEAR(is.angle.x(), wave.imag(), 2e-5 * size);
    ASSERT_NEAR(is.rate.x(), (s * wave).imag(), 2e-4 * size * omega);
    ASSERT_NEAR(is.angular_acceleration.x(), (s * s * wave).imag(), 1e-2 * size * omega * omega);
  }
}

TEST(PlatformSimulator, ComesToRestWhereItIsToldOrWhereItWasMeasuredTo) {
  for (const auto& [name, angle, expected] :
       {std::tuple("three_axis", 15.0, 15.0), std::tuple("three_axis_measured", 15.0, 14.0),
        std::tuple("three_axis_measured", 20.0, 18.5), std::tuple("three_axis_measured", -15.0, -14.0)}) {
    PlatformSimulator simulator(built_in_platform(name));
    PlatformState ordered;
    simulator.reset(ordered);
    ordered.angle.y() = angle * kDegree;
    PlatformState is;
    for (int k = 0; k < 1000; ++k) is = simulator.step(ordered, 0.01);
    EXPECT_NEAR(is.angle.y(), expected * kDegree, 1e-9) << name;
    EXPECT_LT(is.rate.norm() + is.angular_acceleration.norm(), 1e-6);
  }
}

TEST(PlatformSimulator, KeepsEveryLegWithinItsStrokeWhereAxesTogetherAskForMore) {
  const Platform p = built_in_platform("hexapod");
  PlatformGuard guard(p.limits);
  PlatformSimulator simulator(p);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> side(-1, 1);
  PlatformCommand desired;
  double longest = 0.0, fastest = 0.0;
  for (int k = 0; k < 6000; ++k) {
    if (k % 150 == 0) {
      for (int i = 0; i < 3; ++i) {
        desired.shift(i) = side(random);
        desired.angle(i) = side(random);
      }
    }
    simulator.step(guard.step(desired, 0.01), 0.01);
    longest = std::max(longest, simulator.leg_positions().cwiseAbs().maxCoeff());
    fastest = std::max(fastest, simulator.leg_rates().cwiseAbs().maxCoeff());
  }
  EXPECT_LE(longest, p.legs->leg.highest);
  EXPECT_GT(longest, 0.9 * p.legs->leg.highest);
  EXPECT_LE(fastest, p.legs->leg.rate * 1.001);  // a critically damped system does not overshoot a limited rate
}

TEST(PlatformSimulator, ACopyGoesOnAlike) {
  PlatformSimulator simulator(built_in_platform("hexapod"));
  PlatformState ordered;
  simulator.reset(ordered);
  for (int k = 0; k < 50; ++k) {
    ordered.shift.x() = 0.002 * k;
    simulator.step(ordered, 0.013);
  }
  PlatformSimulator copy = simulator;
  for (int k = 0; k < 50; ++k) {
    ordered.angle.z() = 0.003 * k;
    ASSERT_EQ(simulator.step(ordered, 0.02).shift, copy.step(ordered, 0.02).shift);
    ASSERT_EQ(simulator.state().angle, copy.state().angle);
  }
}

}  // namespace
}  // namespace veridyn::cueing
