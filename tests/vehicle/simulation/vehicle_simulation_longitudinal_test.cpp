#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/vehicle/simulation/drives.hpp"
#include "veridyn/core/constants.hpp"

// Drives whose speed follows from torques, drag and grade.

namespace veridyn::vehicle {
namespace {

using testing::car_with_bars;
using testing::drive;
using testing::hands_off;
using testing::linear_car;
using testing::LinearCar;
using testing::with_longitudinal;

/// By which the weight of a body that leans or pitches by 1 rad pushes [N].
double tilting(const VehicleParameters<double>& p) { return (p.mass - 4.0 * p.unsprung_mass) * kGravity; }

TEST(FourWheelSimulation, StopsInTheDistanceThatFrictionLeaves) {
  VehicleParameters<double> p = car_with_bars();
  p.mu = 0.8;
  p.cg_height = 0.0;  // no pitch: the loads stay
  const auto car = linear_car(p, with_longitudinal({.drag_area = 0.0, .rolling_resistance = 0.0}));
  const auto out =
      drive(car, [](double) { return Controls{.brake_torque = 20000.0}; }, {.duration = 10.0, .speed = 25.0});
  ASSERT_EQ(out.end, DriveEnd::kStopped) << out.message();
  const double left = out.u.back();  // at or just below 0.5 m/s
  EXPECT_LE(left, 0.5);
  // The wheels take some hundredths of a second to lock: until then they brake less.
  EXPECT_NEAR(out.x.back(), (25.0 * 25.0 - left * left) / (2.0 * 0.8 * kGravity), 0.1);
  for (std::size_t i = 0; i < kWheels; ++i) {
    EXPECT_EQ(out.wheel_speed[i].back(), 0.0);
    EXPECT_NEAR(out.slip_ratio[i][out.size() - 2], -1.0, 1e-12);
    for (const double spin : out.wheel_speed[i]) EXPECT_GE(spin, 0.0);
  }
}

TEST(FourWheelSimulation, BrakesWithMoreLoadInFrontByHeightOverWheelbase) {
  VehicleParameters<double> p = car_with_bars();
  const auto car = linear_car(p, with_longitudinal({.drag_area = 0.0, .rolling_resistance = 0.0}));
  const auto out = drive(car, [](double t) { return Controls{.brake_torque = 1000.0 * std::min(1.0, t)}; },
                         {.duration = 4.0, .speed = 40.0});
  ASSERT_EQ(out.end, DriveEnd::kCompleted);
  const double a_x = out.longitudinal_acceleration.back();
  // The spinning wheels are slowed too: m a R = -T + 4 I_w a/R, but for the slip.
  EXPECT_NEAR(a_x * (p.mass * 0.3 + 4.0 * 1.0 / 0.3), -1000.0, 3.0);
  const double moved = 0.5 * (out.Fz[0].back() + out.Fz[1].back() - out.Fz[2].back() - out.Fz[3].back()) -
                       0.5 * p.mass * kGravity * (p.b - p.a) / (p.a + p.b);
  EXPECT_NEAR(moved, (-p.mass * a_x + tilting(p) * out.pitch.back()) * p.cg_height / (p.a + p.b), 1e-3 * moved);
  EXPECT_GT(out.pitch.back(), 0.0);
}

// Drag and rolling resistance alone: (m + 4 I_w/R^2) u' = -(A + B u^2), u = sqrt(A/B) tan(phi_0 - sqrt(A B) t/m_eff).
TEST(FourWheelSimulation, CoastsDownAsTheClosedFormSays) {
  VehicleParameters<double> p = car_with_bars();
  const LongitudinalParameters l{.wheel_inertia = 0.8, .rolling_resistance = 0.015};
  LinearTyre<double> stiff{.stiffness = 60000.0, .slip_stiffness = 3e6};  // hardly slips
  const LinearCar<double> car(p, {stiff, stiff, stiff, stiff}, with_longitudinal(l));
  const auto out = drive(car, hands_off, {.duration = 30.0, .speed = 40.0});
  ASSERT_EQ(out.end, DriveEnd::kCompleted);
  const double A = l.rolling_resistance * p.mass * kGravity, B = 0.5 * l.air_density * l.drag_area;
  const double mass = p.mass + 4.0 * l.wheel_inertia / (l.wheel_radius * l.wheel_radius);
  const double phase = std::atan(40.0 * std::sqrt(B / A)) - std::sqrt(A * B) / mass * 30.0;
  EXPECT_NEAR(out.u.back(), std::sqrt(A / B) * std::tan(phase), 2e-3);
  EXPECT_LT(out.u.back(), 31.0);
}

TEST(FourWheelSimulation, ClimbsAGradeAtTheTorqueThatItTakes) {
  const VehicleParameters<double> p = car_with_bars();
  const LongitudinalParameters l{.drag_area = 0.0, .rolling_resistance = 0.0, .grade = 0.08};
  const double torque = p.mass * kGravity * std::sin(l.grade) * l.wheel_radius;
  const auto out = drive(linear_car(p, with_longitudinal(l)), [&](double) { return Controls{.drive_torque = torque}; },
                         {.duration = 10.0});
  EXPECT_NEAR(out.longitudinal_acceleration.back(), 0.0, 1e-6);
  EXPECT_NEAR(out.u.back(), 20.0, 0.1);
  double load = 0.0;
  for (const auto& column : out.Fz) load += column.back();
  EXPECT_NEAR(load, p.mass * kGravity * std::cos(l.grade), 1e-6);
  // The tyres push at the road: weight moves to the rear as when accelerating.
  const double moved = 0.5 * (out.Fz[2].back() + out.Fz[3].back() - out.Fz[0].back() - out.Fz[1].back()) -
                       0.5 * p.mass * kGravity * std::cos(l.grade) * (p.a - p.b) / (p.a + p.b);
  EXPECT_LT(out.pitch.back(), 0.0);
  EXPECT_NEAR(moved,
              (torque / l.wheel_radius - std::cos(l.grade) * tilting(p) * out.pitch.back()) * p.cg_height / (p.a + p.b),
              1e-4 * moved);
}

// Fast wheels are followed at the step in fourth order. Slow ones, which relax in less than a step (here in 0.2 ms),
// need parts of it, and are followed better than that.
TEST(FourWheelSimulation, FollowsTheWheelsSpinAtAnySpeed) {
  const auto car = linear_car(car_with_bars(), with_longitudinal({}));
  const auto error = [&](double speed, double step) {
    const auto controls = [](double t) { return Controls{.steer = 0.02 * std::sin(t), .drive_torque = 600.0 * t}; };
    const auto run = [&](double h) {
      const auto out = drive(car, controls, {.duration = 1.2, .step = h, .output_step = 1.2, .speed = speed});
      EXPECT_EQ(out.end, DriveEnd::kCompleted);
      return out;
    };
    const auto one = run(step), exact = run(6.25e-5);
    return std::hypot(one.u.back() - exact.u.back(), one.wheel_speed[2].back() - exact.wheel_speed[2].back());
  };
  const double coarse = error(30.0, 2e-3), fine = error(30.0, 1e-3), finer = error(30.0, 5e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.3);
  EXPECT_NEAR(std::log2(fine / finer), 4.0, 0.3);
  EXPECT_LT(error(2.0, 1e-3), 1e-8);
  EXPECT_LT(error(2.0, 4e-3), 1e-6);
}

TEST(FourWheelSimulation, EndsWhereTheVehicleStopsOrSpins) {
  const auto coasting = drive(linear_car(car_with_bars(), with_longitudinal({})),
                              [](double) { return Controls{.brake_torque = 200.0}; }, {.duration = 60.0, .speed = 2.0});
  EXPECT_EQ(coasting.end, DriveEnd::kStopped);
  EXPECT_LT(coasting.end_time, 60.0);
  EXPECT_EQ(coasting.time.back(), coasting.end_time);
  EXPECT_NE(coasting.message().find("came to a stop"), std::string::npos);
  VehicleParameters<double> loose = car_with_bars();
  loose.mu = 0.5;
  loose.C_r = 30000.0;
  const auto spinning =
      drive(linear_car(loose, with_longitudinal({})),
            [](double t) { return Controls{.steer = 0.1 * std::min(1.0, t), .drive_torque = 2000.0}; },
            {.duration = 60.0, .speed = 30.0});
  EXPECT_EQ(spinning.end, DriveEnd::kSpun) << spinning.message();
  EXPECT_TRUE(spinning.usable());
}

}  // namespace
}  // namespace veridyn::vehicle
