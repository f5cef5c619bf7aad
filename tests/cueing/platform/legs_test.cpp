#include "veridyn/cueing/platform/legs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

using ::testing::HasSubstr;

/// Half of the range along every axis, in both directions.
PlatformState any_state(const PlatformLimits& limits, std::mt19937& random) {
  std::uniform_real_distribution<double> part(-0.5, 0.5);
  PlatformState s;
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const AxisLimits& l = limits.axes[i];
    if (!l.moves()) continue;
    const double p = part(random);
    set_axis(s, static_cast<PlatformAxis>(i),
             {p * (p > 0.0 ? l.highest : -l.lowest), part(random) * l.rate, part(random) * l.acceleration});
  }
  return s;
}

struct Rig {
  LegGeometry geometry;
  PlatformLimits limits;
};

std::vector<Rig> rigs() { return {{three_legs(), three_axis_limits()}, {six_legs(), hexapod_limits()}}; }

TEST(Legs, PoseAndMotionComeBackFromTheirLengths) {
  std::mt19937 random(1);
  for (const Rig& c : rigs()) {
    const Legs legs(c.geometry, c.limits);
    for (int k = 0; k < 200; ++k) {
      const PlatformState s = any_state(c.limits, random);
      const std::optional<PlatformState> back = legs.state(legs.lengths(s), {});
      ASSERT_TRUE(back);
      for (std::size_t i = 0; i < kPlatformAxes; ++i) {
        const AxisState a = axis(s, static_cast<PlatformAxis>(i)), b = axis(*back, static_cast<PlatformAxis>(i));
        EXPECT_NEAR(a.position, b.position, 1e-11);
        EXPECT_NEAR(a.rate, b.rate, 1e-10);
        EXPECT_NEAR(a.acceleration, b.acceleration, 1e-8);
      }
    }
  }
}

TEST(Legs, RatesAreThoseOfTheLengthsAlongTheMotion) {
  std::mt19937 random(2);
  for (const Rig& c : rigs()) {
    const Legs legs(c.geometry, c.limits);
    for (int k = 0; k < 50; ++k) {
      const PlatformState s = any_state(c.limits, random);
      const double h = 1e-4;
      const auto later = [&](double t) {
        PlatformState p = s;
        p.shift += t * s.velocity + 0.5 * t * t * s.acceleration;
        p.angle += t * s.rate + 0.5 * t * t * s.angular_acceleration;
        return legs.lengths(p).position;
      };
      const Legs::Lengths l = legs.lengths(s);
      EXPECT_LT(((later(h) - later(-h)) / (2.0 * h) - l.rate).norm(), 1e-6);
      EXPECT_LT(((later(h) - 2.0 * later(0.0) + later(-h)) / (h * h) - l.acceleration).norm(), 1e-5);
    }
  }
}

TEST(Legs, UprightOnesAreLongerByTheHeaveAndByTheTriangleTilted) {
  const Legs legs(three_legs(), three_axis_limits());
  PlatformState s;
  s.shift.z() = 0.07;
  for (Eigen::Index i = 0; i < 3; ++i) EXPECT_NEAR(legs.lengths(s).position(i), 0.07, 1e-15);
  s = {};
  s.angle.y() = 12.0 * kDegree;  // the nose up: the front leg, 0.45 m ahead, the longer
  const double up = 0.6 + 0.45 * std::sin(12.0 * kDegree), back = 0.45 * (1.0 - std::cos(12.0 * kDegree));
  EXPECT_NEAR(legs.lengths(s).position(0), std::hypot(up, back) - 0.6, 1e-15);
  s = {};
  s.angle.x() = 10.0 * kDegree;  // the right side down
  EXPECT_LT(legs.lengths(s).position(2), -0.05);
  EXPECT_GT(legs.lengths(s).position(1), 0.05);
}

std::string refusal(const LegGeometry& g, const PlatformLimits& limits) {
  try {
    const Legs legs(g, limits);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Legs, RefusesThoseThatDoNotReachOrDoNotHold) {
  LegGeometry g = three_legs();
  g.leg.highest = 0.09;
  EXPECT_THAT(refusal(g, three_axis_limits()), HasSubstr("platform.heave"));
  g = three_legs();
  g.heads.pop_back();
  EXPECT_THAT(refusal(g, three_axis_limits()), HasSubstr("3 feet and 2 heads"));
  g = three_legs();
  for (auto* points : {&g.feet, &g.heads}) {
    for (Eigen::Vector3d& p : *points) p.y() = 0.0;  // all on one line: nothing holds the roll
  }
  EXPECT_THAT(refusal(g, three_axis_limits()), HasSubstr("do not hold"));
}

}  // namespace
}  // namespace veridyn::cueing
