#include "veridyn/vehicle/simulation/stepped_drive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/vehicle/simulation/drives.hpp"
#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/simulation/trajectory_motion.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle {
namespace {

using testing::car_with_bars;
using testing::linear_car;
using testing::LinearCar;
using testing::with_longitudinal;
using Drive = SteppedDrive<LinearTyre<double>>;

constexpr double kDriveStep = 1e-3;

/// A car with friction.
LinearCar<double> gripping_car(const LongitudinalParameters& longitudinal = {}) {
  VehicleParameters<double> p = car_with_bars();
  p.mu = 0.9;
  return linear_car(p, with_longitudinal(longitudinal));
}

/// Controls that stay over a step.
struct HeldControls : Driver {
  double now = 0.0;
  void look(double time, const PlanarMotion& /*motion*/) override { now = time; }
  [[nodiscard]] static Controls at(double t) {
    return {
        .steer = 0.04 * std::sin(2.0 * t), .drive_torque = 400.0 * std::sin(t), .brake_torque = t > 3.0 ? 300. : 0.};
  }
  [[nodiscard]] Controls controls(double /*time*/) const override { return at(now); }
};

void expect_same_as_simulate(const LinearCar<double>& car, double speed) {
  const auto road = std::make_shared<testing::SignalRoad>(testing::bumps);
  HeldControls driver;
  Progress silent;
  const auto whole =
      simulate(car, driver, road.get(), {.duration = 5.0, .output_step = kDriveStep, .speed = speed}, silent);
  ASSERT_EQ(whole.end, DriveEnd::kCompleted) << whole.message();
  Drive drive(car, road, speed), at_sample(car, road, speed);
  drive.reset(speed);
  const Eigen::Vector3d head(0.2, 0.4, 0.7);
  const auto motions = motion_samples(whole, car.options().gravity);
  for (std::size_t k = 0; k + 1 < whole.size(); ++k) {
    drive.step(HeldControls::at(whole.time[k]), whole.time[k + 1] - whole.time[k]);
    const FourWheelState<double>& s = drive.state().vehicle;
    ASSERT_EQ(s(kX), whole.x[k + 1]) << k;
    ASSERT_EQ(s(kYaw), whole.yaw[k + 1]) << k;
    ASSERT_EQ(s(kU), whole.u[k + 1]) << k;
    ASSERT_EQ(s(kRoll), whole.roll[k + 1]) << k;
    ASSERT_EQ(s(kHeaveRate), whole.heave_rate[k + 1]) << k;
    if (car.options().longitudinal) {
      ASSERT_EQ(s(kWheelSpin + 3), whole.wheel_speed[3][k + 1]) << k;
    }
    // What is felt, with the controls that a sample of the simulation has: those of the step that begins.
    DriveState beginning = drive.state();
    beginning.controls = HeldControls::at(whole.time[k + 1]);
    at_sample.reset(beginning);
    const recording::MotionSample here = at_sample.motion(head), there = recording::at_place(motions[k + 1], head);
    ASSERT_LT((here.force - there.force).norm(), 1e-9) << k;
    ASSERT_LT((here.angular_acceleration - there.angular_acceleration).norm(), 1e-9) << k;
  }
}

TEST(SteppedDrive, IsTheSimulatedDriveBitForBit) {
  expect_same_as_simulate(gripping_car(), 20.0);
  expect_same_as_simulate(gripping_car(), 9.0);  // here the slip of the wheels takes parts of steps
  expect_same_as_simulate(linear_car(car_with_bars()), 20.0);
}

/// A pedal that moves no faster than 2000 N m/s, as an actuator would.
double towards(double from, double to) { return from + std::clamp(to - from, -2.0, 2.0); }

TEST(SteppedDrive, StartsStopsReversesAndComesBackWithoutAJump) {
  Drive drive(gripping_car());
  Controls c;
  double largest_jump = 0.0, last = 0.0, forward = 0.0, backward = 0.0;
  const double goals[] = {20.0, 0.0, -2.0, 0.0, 5.0};
  for (const double goal : goals) {
    for (int k = 0; k < 14000; ++k) {
      const double u = drive.state().vehicle(kU);
      // Drives towards the goal's speed, and brakes where it is to stand.
      const bool stop = goal == 0.0;
      c.drive_torque = towards(c.drive_torque, stop ? 0.0 : std::clamp(900.0 * (goal - u), -900.0, 900.0));
      c.brake_torque = towards(c.brake_torque, stop ? 900.0 : 0.0);
      drive.step(c, kDriveStep);
      const double a = drive.rates().longitudinal_acceleration;
      largest_jump = std::max(largest_jump, std::abs(a - last));
      last = a;
      forward = std::max(forward, u);
      backward = std::min(backward, u);
    }
    EXPECT_NEAR(drive.state().vehicle(kU), goal, goal == 0.0 ? 1e-6 : 0.15);
  }
  EXPECT_GT(forward, 19.8);
  EXPECT_LT(backward, -1.9);
  // Brakes of 900 N m decelerate by 2.72 m/s^2, which the tyres take back once the wheels stand, at the rate of their
  // damper: sum(C_x) d/m = 60.3 1/s, or 0.164 m/s^2 a step; a fifth more where the body pitches.
  EXPECT_LT(largest_jump, 1.2 * 0.164);
  EXPECT_EQ(drive.state().refused, 0);
}

TEST(SteppedDrive, StaysParkedOnAGradeAndRollsWhenReleased) {
  const LongitudinalParameters l{.drag_area = 0.0, .rolling_resistance = 0.0, .grade = std::atan(0.1)};
  const auto car = gripping_car(l);
  Drive drive(car);
  const Controls parked{.brake_torque = 3000.0};
  for (int k = 0; k < 3000; ++k) drive.step(parked, kDriveStep);  // settles into its tyres
  const double x = drive.state().vehicle(kX);
  for (int k = 0; k < 60000; ++k) drive.step(parked, kDriveStep);
  EXPECT_NEAR(drive.state().vehicle(kX), x, 1e-6);
  EXPECT_NEAR(x, 0.0, 0.01);
  EXPECT_NEAR(drive.motion().force.norm(), kGravity, 1e-6);
  const double u = drive.state().vehicle(kU), m = car.parameters().mass;
  const double mass = m + 4.0 * l.wheel_inertia / (l.wheel_radius * l.wheel_radius);
  for (int k = 0; k < 5000; ++k) drive.step({}, kDriveStep);
  const double before = drive.state().vehicle(kU);
  for (int k = 0; k < 5000; ++k) drive.step({}, kDriveStep);
  EXPECT_NEAR((drive.state().vehicle(kU) - before) / 5.0, -kGravity * std::sin(l.grade) * m / mass, 1e-3);
  EXPECT_LT(before, u - 3.0);
}

// Wheels locked, no pitching: kinetic energy and that of the tyres' springs, C e^2/(2 sigma).
TEST(SteppedDrive, NeverMakesEnergyAtStandstill) {
  VehicleParameters<double> p = car_with_bars();
  p.cg_height = 0.0;
  const LongitudinalParameters l{};
  const auto car = linear_car(p, with_longitudinal(l));
  Drive drive(car);
  const double sigma = l.wheel_radius / 3.0;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int trial = 0; trial < 20; ++trial) {
    DriveState start;
    start.vehicle(kU) = 0.2 * any(random);
    start.vehicle(kV) = 0.2 * any(random);
    start.vehicle(kR) = 0.1 * any(random);
    for (Eigen::Index i = 0; i < 4; ++i) {
      start.deflection_x[i] = 2e-3 * any(random);
      start.deflection_y[i] = 2e-3 * any(random);
    }
    drive.reset(start);
    const auto energy = [&] {
      const DriveState& s = drive.state();
      double sum = 0.5 * p.mass * (std::pow(s.vehicle(kU), 2) + std::pow(s.vehicle(kV), 2)) +
                   0.5 * p.I_z * std::pow(s.vehicle(kR), 2);
      for (Eigen::Index i = 0; i < 4; ++i) {
        const LinearTyre<double>& tyre = car.tyres()[i];
        sum += 0.5 / sigma *
               (tyre.slip_stiffness * std::pow(s.deflection_x[i], 2) + tyre.stiffness * std::pow(s.deflection_y[i], 2));
      }
      return sum;
    };
    double last = energy();
    const double first = last;
    for (int k = 0; k < 3000; ++k) {
      drive.step({.brake_torque = 1e5}, kDriveStep);
      const double now = energy();
      ASSERT_LE(now, last + 1e-9 * first) << trial << " at " << k;
      last = now;
    }
    // Tyres that pull against each other stay strained; the car does not move.
    EXPECT_LT(drive.state().vehicle.segment<3>(kU).norm(), 1e-6) << trial;
  }
}

TEST(SteppedDrive, GoesOnAfterASpin) {
  VehicleParameters<double> p = car_with_bars();
  p.mu = 0.5;
  p.C_r = 30000.0;
  Drive drive(linear_car(p, with_longitudinal({})));
  drive.reset(30.0);
  bool spun = false;
  for (int k = 0; k < 12000; ++k) {
    drive.step({.steer = 0.1 * std::min(1.0, k * kDriveStep), .drive_torque = 2000.0}, kDriveStep);
    spun |= drive.state().vehicle(kU) < 0.0;
    ASSERT_TRUE(drive.state().vehicle.allFinite()) << k;
  }
  EXPECT_TRUE(spun);
  for (int k = 0; k < 30000; ++k) drive.step({.brake_torque = 4000.0}, kDriveStep);
  EXPECT_LT(std::hypot(drive.state().vehicle(kU), drive.state().vehicle(kV)), 1e-6);
  for (int k = 0; k < 5000; ++k) drive.step({.drive_torque = 500.0}, kDriveStep);
  EXPECT_GT(drive.state().vehicle(kU), 3.0);
  EXPECT_EQ(drive.state().refused, 0);
}

// A high, narrow car whose tyres hold more than it bears.
TEST(SteppedDrive, RollsOverSaysSoAndGoesOn) {
  VehicleParameters<double> p = car_with_bars();
  p.cg_height = 1.1;
  p.track_f = p.track_r = 1.2;
  p.mu = 1.3;
  Drive drive(linear_car(p, with_longitudinal({})));
  drive.reset(25.0);
  bool rolled_over = false;
  for (int k = 0; k < 6000; ++k) {
    drive.step({.steer = 0.2 * std::min(1.0, k * kDriveStep)}, kDriveStep);
    rolled_over |= drive.state().rolled_over;
    ASSERT_TRUE(drive.state().vehicle.allFinite()) << k;
    ASSERT_LE(std::abs(drive.state().vehicle(kRoll)), 45.0 * kDegree * (1.0 + 1e-12)) << k;
  }
  EXPECT_TRUE(rolled_over);
  for (int k = 0; k < 40000; ++k) drive.step({.brake_torque = 4000.0}, kDriveStep);
  EXPECT_TRUE(drive.state().vehicle.allFinite());
  EXPECT_LT(std::hypot(drive.state().vehicle(kU), drive.state().vehicle(kV)), 1e-3);
}

// A whole tyre file, with shifts that push at zero slip.
TEST(SteppedDrive, OnTyresOfAFileStartsStopsReversesAndStaysParked) {
  const TirFile file = parse_tir(testing::small_tir(), "small.tir");
  const auto left = file.on(TyreSide::kLeft), right = file.on(TyreSide::kRight);
  using MagicDrive = SteppedDrive<MagicFormulaTyre<double>>;
  MagicDrive drive(MagicDrive::Model(car_with_bars(), {left, right, left, right}, with_longitudinal({})));
  Controls c;
  double largest_jump = 0.0, last = 0.0;
  const double goals[] = {20.0, 0.0, -2.0, 0.0, 5.0, 0.0};
  for (const double goal : goals) {
    for (int k = 0; k < 14000; ++k) {
      const double u = drive.state().vehicle(kU);
      const bool stop = goal == 0.0;
      c.steer = stop ? 0.0 : 0.02 * std::sin(1e-3 * k);
      c.drive_torque = towards(c.drive_torque, stop ? 0.0 : std::clamp(900.0 * (goal - u), -900.0, 900.0));
      c.brake_torque = towards(c.brake_torque, stop ? 900.0 : 0.0);
      drive.step(c, kDriveStep);
      ASSERT_TRUE(drive.state().vehicle.allFinite());
      const double a = drive.rates().longitudinal_acceleration;
      largest_jump = std::max(largest_jump, std::abs(a - last));
      last = a;
    }
    EXPECT_NEAR(drive.state().vehicle(kU), goal, goal == 0.0 ? 1e-4 : 0.3);
  }
  EXPECT_LT(largest_jump, 0.5);
  const double x = drive.state().vehicle(kX), y = drive.state().vehicle(kY);
  for (int k = 0; k < 20000; ++k) drive.step(c, kDriveStep);
  EXPECT_NEAR(drive.state().vehicle(kX), x, 1e-4);
  EXPECT_NEAR(drive.state().vehicle(kY), y, 1e-4);
  EXPECT_EQ(drive.state().refused, 0);
}

TEST(SteppedDrive, BearsAnyInput) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Drive drive(gripping_car());
  const double bad[] = {kNan, kInfinity, -kInfinity, 1e30, -1e30, 0.0, 1.0, -0.5};
  std::mt19937_64 random(7);
  const auto any = [&] { return bad[random() % std::size(bad)]; };
  const double steps[] = {kDriveStep, 0.05, 0.0, -1.0, kNan, kInfinity};
  for (int k = 0; k < 2000; ++k) {
    drive.step({.steer = any(), .drive_torque = 1000.0 * any(), .brake_torque = 1000.0 * any()},
               steps[random() % std::size(steps)]);
    ASSERT_TRUE(drive.state().vehicle.allFinite()) << k;
    ASSERT_TRUE(drive.motion().force.allFinite()) << k;
  }
  EXPECT_GT(drive.state().refused, 500);
}

TEST(SteppedDrive, GoesOnFromASavedStateBitForBit) {
  Drive drive(gripping_car()), other(gripping_car());
  const auto controls = [](int k) {
    return Controls{
        .steer = 0.1 * std::sin(3e-3 * k), .drive_torque = 500.0, .brake_torque = k % 4000 > 2000 ? 3e3 : 0};
  };
  for (int k = 0; k < 3000; ++k) drive.step(controls(k), kDriveStep);
  other.reset(drive.state());
  for (int k = 3000; k < 9000; ++k) {
    drive.step(controls(k), kDriveStep);
    other.step(controls(k), kDriveStep);
    ASSERT_TRUE(drive.state().vehicle == other.state().vehicle) << k;
  }
}

// Specific force at the driver's head: the second derivative of its place, from the states alone, less gravity. The
// tyres have no friction limit, at which the linear law's slope jumps: differences would not hold across it.
TEST(SteppedDrive, GivesTheSpecificForceAtAnyPlace) {
  Drive drive(linear_car(car_with_bars(), with_longitudinal({})));
  drive.reset(15.0);
  const Eigen::Vector3d head(0.2, 0.4, 0.7);
  struct Place {
    Eigen::Vector3d at;
    recording::MotionSample motion;
  };
  std::vector<Place> path;
  for (int k = 0; k < 3000; ++k) {
    drive.step({.steer = 0.05, .drive_torque = 300.0}, kDriveStep);
    const FourWheelState<double>& s = drive.state().vehicle;
    const recording::MotionSample m = drive.motion(head);
    path.push_back({Eigen::Vector3d(s(kX), s(kY), s(kHeave)) + m.attitude * head, m});
  }
  double worst = 0.0;
  for (std::size_t k = 500; k + 10 < path.size(); ++k) {
    const auto at = [&](int by) { return path[static_cast<int>(k) + by].at; };
    constexpr int kWide = 3;  // of the sixth order: error and rounding both below 1e-7
    const double h = kWide * kDriveStep;
    const Eigen::Vector3d a = ((at(-3 * kWide) + at(3 * kWide)) / 90.0 - 0.15 * (at(-2 * kWide) + at(2 * kWide)) +
                               1.5 * (at(-kWide) + at(kWide)) - 49.0 / 18.0 * at(0)) /
                              (h * h);
    const Eigen::Vector3d f = path[k].motion.attitude.conjugate() * (a + Eigen::Vector3d(0.0, 0.0, kGravity));
    worst = std::max(worst, (f - path[k].motion.force).norm());
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(path.back().motion.force.y(), 3.0);
}

TEST(SteppedDrive, RefusesWhatHasNoStandstill) {
  FourWheelOptions options = with_longitudinal({});
  options.geometry = BicycleGeometry::kSmallAngles;
  EXPECT_THROW(Drive(linear_car(car_with_bars(), options)), InputError);
  EXPECT_THROW(Drive(gripping_car(), nullptr, 0.0), InputError);
}

}  // namespace
}  // namespace veridyn::vehicle
