#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/vehicle/simulation/drives.hpp"
#include "veridyn/core/constants.hpp"

// Roll and lift-off of wheels over whole drives.

namespace veridyn::vehicle {
namespace {

using testing::car_with_bars;
using testing::drive;
using testing::hands_off;
using testing::linear_car;
using testing::SignalRoad;

// In a steady turn the body leans by c sum F_y over the roll stiffness less gravity's tilting moment: tyre, spring and
// bar in series (Milliken & Milliken 1995, chapter 16).
TEST(FourWheelSimulation, LeansAsRollStiffnessLessGravitySays) {
  const VehicleParameters<double> p = car_with_bars();
  const auto axle = [](double spring, double bar, double tyre, double track) {
    const double at_wheel = spring + 2.0 * bar;
    return 0.5 * track * track * at_wheel * tyre / (at_wheel + tyre);
  };
  const double stiffness = axle(p.K_sf, p.K_bf, p.K_tf, p.track_f) + axle(p.K_sr, p.K_br, p.K_tr, p.track_r);
  const double tilting = (p.mass - 4.0 * p.unsprung_mass) * kGravity * p.cg_height;
  EXPECT_GT(tilting / stiffness, 0.04);  // what the test would miss without it
  const auto lean = [&](double steer) {
    const auto out = drive(linear_car(p), [steer](double) { return Controls{.steer = steer}; }, {.duration = 15.0});
    EXPECT_NEAR(out.roll_rate.back(), 0.0, 1e-9);
    const double expected = p.mass * out.lateral_acceleration.back() * p.cg_height / (stiffness - tilting);
    return out.roll.back() / expected - 1.0;
  };
  EXPECT_NEAR(lean(0.005), 0.0, 1e-9);
  EXPECT_NEAR(lean(0.03), 0.0, 1e-9);
}

TEST(FourWheelSimulation, FallsIntoAHoleAndLandsAgain) {
  const SignalRoad hole([](const RoadPoint& at) {
    const bool in = at.offset > 0.0 && at.distance > 20.0 && at.distance < 26.0;
    return in ? -0.3 : 0.0;
  });
  const auto out = drive(linear_car(car_with_bars()), hands_off, {.duration = 6.0, .output_step = 1e-3}, &hole);
  EXPECT_EQ(out.end, DriveEnd::kCompleted);
  ASSERT_FALSE(out.lift_offs.empty());
  // Front left over the edge after (20 - a)/u, rear left b behind.
  const auto first = [&](std::size_t wheel) {
    for (const LiftOff& l : out.lift_offs) {
      if (l.wheel == wheel) return l;
    }
    return LiftOff{};
  };
  EXPECT_NEAR(first(kFrontLeft).from, (20.0 - 1.25) / 20.0, 2e-3);
  EXPECT_NEAR(first(kRearLeft).from, (20.0 + 1.00) / 20.0, 2e-3);
  EXPECT_GT(first(kFrontLeft).to - first(kFrontLeft).from, 0.02);
  EXPECT_NE(out.message().find("wheel fl off the ground from 0.938 to "), std::string::npos) << out.message();
  for (std::size_t k = 0; k < out.size(); ++k) {
    for (std::size_t i = 0; i < kWheels; ++i) {
      bool off = false;
      for (const LiftOff& l : out.lift_offs) {
        off |= l.wheel == i && out.time[k] > l.from - 1e-9 && out.time[k] < l.to - 1e-9;
      }
      EXPECT_EQ(off, out.Fz[i][k] == 0.0) << i << " at " << out.time[k];
      EXPECT_GE(out.Fz[i][k], 0.0);
    }
  }
  // It comes to rest as it was; while one wheel is off the others carry the car.
  for (std::size_t i = 0; i < kWheels; ++i) {
    EXPECT_NEAR(out.Fz[i].back(), linear_car(car_with_bars()).rest_loads()[i], 0.5);
    EXPECT_NEAR(out.wheel_height[i].back(), 0.0, 1e-5);
  }
}

/// A car on springs so stiff that it tips as a block: the inner wheels lift when a_y > g W/(2 c).
TEST(FourWheelSimulation, LiftsItsInnerWheelsAtHalfTheTrackOverTheHeight) {
  VehicleParameters<double> p;
  p.a = p.b = 1.2;
  p.C_f = p.C_r = p.mass * 100.0 / (4.0 * p.b);  // v = 0 in every steady turn at 10 m/s: no pitching
  p.cg_height = 0.9;
  p.unsprung_mass = 5.0;  // tyres and wheels alone carry springs' force to the road
  p.K_sf = p.K_sr = p.K_tf = p.K_tr = 1e7;
  p.C_sf = p.C_sr = 3e4;
  const double threshold = p.track_f / (2.0 * p.cg_height);  // g
  const auto run = [&](double share) {
    // Neutral steer: r = u delta/L.
    const double u = 10.0, a_y = share * threshold * kGravity, steer = a_y * 2.4 / (u * u);
    const auto controls = [steer](double t) {
      const double part = std::clamp(t / 4.0, 0.0, 1.0);
      return Controls{.steer = steer * part * part * (3.0 - 2.0 * part)};
    };
    FourWheelOptions options;
    options.geometry = BicycleGeometry::kSmallAngles;
    return drive(linear_car(p, options), controls, {.duration = 6.0, .step = 1e-4, .speed = u});
  };
  const auto below = run(0.97);
  EXPECT_EQ(below.end, DriveEnd::kCompleted) << below.message();
  EXPECT_TRUE(below.lift_offs.empty()) << below.message();
  EXPECT_NEAR(below.lateral_acceleration.back() / kGravity / threshold, 0.97, 0.01);
  const auto above = run(1.03);
  EXPECT_EQ(above.end, DriveEnd::kRolledOver) << above.message();
  ASSERT_GE(above.lift_offs.size(), 2U);
  for (const LiftOff& l : above.lift_offs) EXPECT_TRUE(is_left(l.wheel));
  EXPECT_NE(above.message().find("the vehicle rolls or pitches beyond 45 deg"), std::string::npos);
}

TEST(FourWheelSimulation, LiftsTwoWheelsInAHardTurnAndSetsThemDownAgain) {
  VehicleParameters<double> p = car_with_bars();
  p.cg_height = 0.75;
  p.I_x = 400.0;
  const auto controls = [](double t) { return Controls{.steer = t > 1.0 && t < 1.5 ? 0.065 : 0.0}; };
  const auto out = drive(linear_car(p), controls, {.duration = 6.0, .output_step = 1e-3});
  EXPECT_EQ(out.end, DriveEnd::kCompleted) << out.message();
  bool two = false;
  for (std::size_t k = 0; k < out.size(); ++k) {
    two |= out.Fz[kFrontLeft][k] == 0.0 && out.Fz[kRearLeft][k] == 0.0;
  }
  EXPECT_TRUE(two) << out.message();
  EXPECT_GT(out.Fz[kFrontLeft].back(), 1000.0);
  EXPECT_NEAR(out.roll.back(), 0.0, 1e-3);
}

}  // namespace
}  // namespace veridyn::vehicle
