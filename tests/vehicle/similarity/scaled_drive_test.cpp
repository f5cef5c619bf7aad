#include "veridyn/vehicle/similarity/scaled_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::vehicle {
namespace {

constexpr ScaleFactors kFactors{.length = 0.2, .mass = 0.008, .speed = 0.4};  // time 0.5, acceleration 0.8

/// Steers in proportion to time, drives with 300 N m and remembers what it saw.
class RememberingDriver : public Driver {
 public:
  void look(double time, const PlanarMotion& motion) override { seen_at = time, seen = motion; }
  [[nodiscard]] Controls controls(double time) const override {
    return {.steer = 0.1 * time, .drive_torque = 300.0, .brake_torque = 50.0};
  }
  double seen_at = 0.0;
  PlanarMotion seen;
};

TEST(ScaledDriver, SeesThePrototypesMotionAndDoesWhatItsDriverDoes) {
  RememberingDriver prototype;
  ScaledDriver driver(prototype, kFactors);
  driver.look(1.0, {.x = 2.0, .y = -1.0, .yaw = 0.3, .u = 8.0, .v = 0.4, .r = 1.0});
  EXPECT_DOUBLE_EQ(prototype.seen_at, 2.0);
  EXPECT_DOUBLE_EQ(prototype.seen.x, 10.0);
  EXPECT_DOUBLE_EQ(prototype.seen.y, -5.0);
  EXPECT_DOUBLE_EQ(prototype.seen.yaw, 0.3);
  EXPECT_DOUBLE_EQ(prototype.seen.u, 20.0);
  EXPECT_DOUBLE_EQ(prototype.seen.v, 1.0);
  EXPECT_DOUBLE_EQ(prototype.seen.r, 0.5);
  const Controls controls = driver.controls(1.0);
  EXPECT_DOUBLE_EQ(controls.steer, 0.2);
  EXPECT_DOUBLE_EQ(controls.drive_torque, 300.0 * 0.008 * 0.8 * 0.2);
  EXPECT_DOUBLE_EQ(controls.brake_torque, 50.0 * 0.008 * 0.8 * 0.2);
}

/// A height from every coordinate of its point, in different ways.
class CurvedRoad : public Road {
 public:
  [[nodiscard]] double height(const RoadPoint& p) const override {
    return std::sin(p.x) + p.y * p.y + 0.1 * p.distance + std::cos(p.offset);
  }
};

TEST(ScaledRoad, HasTheSameShape) {
  const CurvedRoad road;
  const ScaledRoad small(road, 0.2);
  const RoadPoint p{.x = 1.0, .y = -2.0, .distance = 3.0, .offset = 0.7};
  const RoadPoint in_model{.x = 0.2, .y = -0.4, .distance = 0.6, .offset = 0.14};
  EXPECT_NEAR(small.height(in_model), 0.2 * road.height(p), 1e-15);
}

// The forces along the way scale with all others: drag by area and speed, and what it takes to spin a wheel up.
TEST(ScaledVehicle, ForcesAlongTheWayScaleWithTheOthers) {
  Vehicle car;
  car.speed = 20.0;
  car.relaxation_length = 0.5;
  const Vehicle model = scaled(car, kFactors);
  const auto drag = [](const Vehicle& v) {
    return 0.5 * v.longitudinal.air_density * v.longitudinal.drag_area * *v.speed * *v.speed;
  };
  EXPECT_NEAR(drag(model) / drag(car), kFactors.force(), 1e-12);
  // A force at the rim spins it up in a time, and a wheel rolls at u/R.
  const auto rim_force = [](const Vehicle& v, double time) {
    const LongitudinalParameters& l = v.longitudinal;
    return l.wheel_inertia * (*v.speed / l.wheel_radius) / time / l.wheel_radius;
  };
  EXPECT_NEAR(rim_force(model, kFactors.time()) / rim_force(car, 1.0), kFactors.force(), 1e-12);
  EXPECT_DOUBLE_EQ(model.relaxation_length, 0.1);
  EXPECT_EQ(model.longitudinal.rolling_resistance, car.longitudinal.rolling_resistance);
}

}  // namespace
}  // namespace veridyn::vehicle
