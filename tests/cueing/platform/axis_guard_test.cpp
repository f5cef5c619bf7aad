#include "veridyn/cueing/platform/axis_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include "veridyn/core/error.hpp"
#include "veridyn/cueing/platform/platform.hpp"

namespace veridyn::cueing {
namespace {

AxisLimits roll() {
  return {.lowest = -15.0 * kDegree,
          .highest = 20.0 * kDegree,
          .rate = 30.0 * kDegree,
          .acceleration = 200.0 * kDegree,
          .jerk = 4000.0 * kDegree};
}

/// The axis kept the limits at the sample and on the mean since the last one.
void expect_inside(const AxisState& before, const AxisState& after, double step, const AxisLimits& limits) {
  constexpr double kRounding = 1e-12;
  ASSERT_TRUE(std::isfinite(after.position) && std::isfinite(after.rate) && std::isfinite(after.acceleration));
  ASSERT_GE(after.position, limits.lowest);
  ASSERT_LE(after.position, limits.highest);
  ASSERT_LE(std::abs(after.rate), limits.rate);
  ASSERT_LE(std::abs(after.acceleration), limits.acceleration + kRounding);
  ASSERT_LE(std::abs(after.acceleration - before.acceleration), limits.jerk * step * (1.0 + 1e-9) + kRounding);
  ASSERT_LE(std::abs(after.rate - before.rate), limits.acceleration * step * (1.0 + 1e-9) + kRounding);
  ASSERT_LE(std::abs(after.position - before.position), limits.rate * step * (1.0 + 1e-9) + kRounding);
}

TEST(AxisGuard, FollowsWhatTheLimitsAllowWithoutDelay) {
  for (const double step : {0.001, 0.01, 0.02}) {
    AxisGuard guard(roll());
    double worst = 0.0;
    for (double t = step; t < 10.0; t += step) {
      const double desired = 8.0 * kDegree * std::pow(std::sin(2.0 * t), 3);
      worst = std::max(worst, std::abs(guard.step(desired, step).position - desired));
      if (step > 0.01) continue;  // corners between coarser steps are rounded off by the jerk
      ASSERT_FALSE(guard.limited()) << t;
    }
    EXPECT_LT(worst, 0.02 * kDegree) << step;
  }
}

TEST(AxisGuard, GoesToAFarPositionAndStopsThere) {
  AxisGuard guard(roll());
  double highest = 0.0;
  int there = 0;
  for (int k = 0; k < 400; ++k) {
    const AxisState s = guard.step(1.0, 0.01);
    highest = std::max(highest, s.position);
    if (s.position > 19.9 * kDegree && there == 0) there = k;
  }
  EXPECT_NEAR(guard.state().position, 20.0 * kDegree, 1e-6);
  EXPECT_LE(highest, 20.0 * kDegree);
  EXPECT_LT(std::abs(guard.state().rate), 1e-6);
  // 20 deg at 30 deg/s, 0.15 s to gain the rate and some more to lose it.
  EXPECT_LT(there, 110);
}

/// 20 deg at 30 deg/s: held back on all of the way, by the rate in the middle of it; no more where it has arrived.
TEST(AxisGuard, IsLimitedWhileItLagsAndBeyondItsRange) {
  AxisGuard guard(roll());
  guard.reset(0.0);
  int limited = 0, lagging = 0;
  for (int k = 0; k < 200; ++k) {
    const AxisState s = guard.step(15.0 * kDegree, 0.01);
    const bool lags = 15.0 * kDegree - s.position > 0.5 * kDegree;
    lagging += lags ? 1 : 0;
    limited += lags && guard.limited() ? 1 : 0;
  }
  EXPECT_GT(lagging, 40);
  EXPECT_GE(limited, lagging - 3);
  EXPECT_FALSE(guard.limited());
  for (int k = 0; k < 200; ++k) (void)guard.step(2.0 * roll().highest, 0.01);
  EXPECT_NEAR(guard.state().position, roll().highest, 1e-6);
  EXPECT_TRUE(guard.limited());
  for (int k = 0; k < 200; ++k) (void)guard.step(roll().highest, 0.01);
  EXPECT_FALSE(guard.limited());
}

/// A step that the jerk cannot follow ends where it leads to, without swinging on.
TEST(AxisGuard, ComesToRestAfterStepsOfAnySize) {
  const PlatformLimits& platform = built_in_platform("three_axis").limits;
  for (const PlatformAxis which : {PlatformAxis::kPitch, PlatformAxis::kRoll, PlatformAxis::kHeave}) {
    const AxisLimits& limits = platform[which];
    for (const double share : {0.002, 0.01, 0.03, 0.1, 0.3, 0.7, 1.0}) {
      for (const double step : {0.001, 0.01, 1.0 / 60.0}) {
        AxisGuard guard(limits);
        guard.reset(0.0);
        const double desired = share * limits.highest;
        double overshoot = 0.0, late = 0.0;
        for (double t = 0.0; t < 3.0; t += step) {
          const double off = guard.step(desired, step).position - desired;
          overshoot = std::max(overshoot, off);
          if (t > 1.5) late = std::max(late, std::abs(off));
        }
        EXPECT_LT(late, 1e-3 * desired) << name_of(which) << " " << share << " " << step;
        EXPECT_LT(overshoot, 0.15 * desired + 0.005 * limits.highest) << name_of(which) << " " << share << " " << step;
      }
    }
  }
}

TEST(AxisGuard, BrakesBeforeTheLimitWhenDrivenAgainstItAtFullRate) {
  AxisGuard guard(roll());
  for (int k = 0; k < 300; ++k) {
    const AxisState before = guard.state();
    const AxisState after = guard.step(-15.0 * kDegree + (k % 2 == 0 ? -5.0 : 0.0), 0.01);
    expect_inside(before, after, 0.01, roll());
  }
  EXPECT_NEAR(guard.state().position, -15.0 * kDegree, 1e-6);
}

TEST(AxisGuard, StopsInAGap) {
  AxisGuard guard(roll());
  for (int k = 0; k < 40; ++k) guard.step(0.3, 0.01);
  const AxisState moving = guard.state();
  ASSERT_GT(moving.rate, 10.0 * kDegree);
  const AxisState after = guard.step(0.0, 2.0);
  EXPECT_EQ(after.rate, 0.0);
  EXPECT_EQ(after.acceleration, 0.0);
  EXPECT_GT(after.position, moving.position);
  // What is desired is elsewhere then: no jump.
  expect_inside(after, guard.step(0.0, 0.01), 0.01, roll());
}

TEST(AxisGuard, IgnoresTimeThatDoesNotGoOnAndValuesThatAreNone) {
  AxisGuard guard(roll());
  for (int k = 0; k < 20; ++k) guard.step(0.1, 0.01);
  const AxisState before = guard.state();
  for (const double step : {0.0, -1.0, kNaN, kInfinity}) EXPECT_EQ(guard.step(0.2, step).position, before.position);
  AxisGuard copy = guard;
  for (int k = 0; k < 50; ++k) {
    EXPECT_EQ(guard.step(k % 3 == 0 ? kNaN : 0.1, 0.01).position, copy.step(0.1, 0.01).position);
  }
}

TEST(AxisGuard, LeadsTheAxisToNewLimitsUnderTheOldOnes) {
  AxisGuard guard(roll());
  for (int k = 0; k < 70; ++k) guard.step(19.0 * kDegree, 0.01);
  const AxisLimits narrow = {.lowest = -5.0 * kDegree,
                             .highest = 5.0 * kDegree,
                             .rate = 3.0 * kDegree,
                             .acceleration = 20.0 * kDegree,
                             .jerk = 100.0 * kDegree};
  guard.change_limits(narrow);
  int steps = 0;
  for (; guard.limits().highest > narrow.highest && steps < 2000; ++steps) {
    const AxisState before = guard.state();
    expect_inside(before, guard.step(19.0 * kDegree, 0.01), 0.01, roll());
  }
  EXPECT_LT(steps, 800);
  for (int k = 0; k < 500; ++k) {
    const AxisState before = guard.state();
    expect_inside(before, guard.step(k % 100 < 50 ? 1.0 : -1.0, 0.01), 0.01, narrow);
  }
}

/// Anything: noise, jumps, values that are none, pauses, time that goes back, other limits, states of others.
void run_adversary(long steps, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  const auto any_limits = [&] {
    const double high = 0.01 + uniform(random), acceleration = std::pow(10.0, 2.0 * uniform(random) - 0.5);
    return AxisLimits{.lowest = -0.01 - uniform(random),
                      .highest = high,
                      .rate = std::pow(10.0, 2.0 * uniform(random) - 1.5),
                      .acceleration = acceleration,
                      .jerk = acceleration * std::pow(10.0, 2.0 * uniform(random))};
  };
  AxisGuard guard(any_limits());
  std::vector<AxisGuard> others(4, guard);
  double desired = 0.0, drift = 0.0;
  for (long k = 0; k < steps; ++k) {
    const double what = uniform(random);
    if (what < 0.3) drift = 3.0 * normal(random);
    if (what < 0.5) {
      desired += 0.01 * drift;
    } else if (what < 0.6) {
      desired = 0.7 * normal(random);
    } else if (what < 0.62) {
      desired = 1e30 * normal(random);
    } else if (what < 0.64) {
      desired = kNaN;
    } else if (what < 0.66) {
      desired = what < 0.65 ? kInfinity : -kInfinity;
    } else if (what < 0.7) {
      desired = 0.1 * normal(random);
    }
    if (!(std::abs(desired) < 10.0) && what > 0.7) desired = 0.0;
    double step = 0.01;
    const double when = uniform(random);
    if (when < 0.2) step = 0.007 + 0.024 * uniform(random);
    if (when < 0.02) step = 5.0 * uniform(random);
    if (when < 0.01) step = -uniform(random);
    if (when < 0.005) step = 0.0;
    if (when < 0.002) step = kNaN;
    if (when > 0.9) step = 1e-3 * uniform(random);
    if (uniform(random) < 1e-3) guard.change_limits(any_limits());
    if (uniform(random) < 1e-3) {
      auto& other = others[static_cast<std::size_t>(4.0 * uniform(random))];
      std::swap(guard, other);
    }
    const AxisState before = guard.state();
    const AxisLimits in_force_before = guard.limits();
    const AxisState after = guard.step(desired, step);
    // Either those before or those that were taken over: the axis is within both at the change.
    AxisLimits limits = guard.limits();
    limits.jerk = std::max(limits.jerk, in_force_before.jerk);
    limits.acceleration = std::max(limits.acceleration, in_force_before.acceleration);
    expect_inside(before, after, step > 0.0 ? step : 0.0, limits);
    ASSERT_FALSE(::testing::Test::HasFatalFailure()) << "step " << k << " of seed " << seed;
  }
}

TEST(AxisGuard, KeepsItsLimitsWhateverIsWanted) {
  for (unsigned seed = 1; seed <= 10; ++seed) run_adversary(10000, seed);
}

TEST(AxisGuardSoak, KeepsItsLimitsInTenMillionSteps) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "set VERIDYN_SOAK=1";
  for (unsigned seed = 100; seed < 110; ++seed) run_adversary(1000000, seed);
}

TEST(AxisGuard, RefusesLimitsThatAreNone) {
  AxisLimits limits = roll();
  limits.acceleration = 0.0;
  EXPECT_THROW(AxisGuard{limits}, InputError);
  limits = roll();
  limits.lowest = 0.1;
  EXPECT_THROW(AxisGuard{limits}, InputError);
}

}  // namespace
}  // namespace veridyn::cueing
