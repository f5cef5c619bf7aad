#include "veridyn/vehicle/manoeuvre/turn_braking_driver.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/refusal.hpp"

namespace veridyn::vehicle {
namespace {

/// Steers more and more, and counts how often it looks.
struct Restless : Driver {
  explicit Restless(int& looks) : looks_(looks) {}
  void look(double /*time*/, const PlanarMotion& /*motion*/) override { ++looks_; }
  [[nodiscard]] Controls controls(double time) const override { return {.steer = 0.01 * time, .drive_torque = 300.0}; }

 private:
  int& looks_;
};

TEST(TurnBrakingDriver, HoldsTheSteeringAndBrakesFromItsTimeOn) {
  int looks = 0;
  TurnBrakingDriver driver(std::make_unique<Restless>(looks),
                           {.brake_time = 5.0, .brake_torque = 1800.0, .rise_time = 0.2});
  driver.look(4.0, {});
  EXPECT_EQ(looks, 1);
  EXPECT_EQ(driver.controls(4.0).steer, 0.04);
  EXPECT_EQ(driver.controls(4.0).drive_torque, 300.0);
  EXPECT_EQ(driver.controls(4.0).brake_torque, 0.0);
  driver.look(6.0, {});
  EXPECT_EQ(looks, 1);
  EXPECT_NEAR(driver.controls(5.1).brake_torque, 900.0, 1e-9);
  for (const double time : {5.2, 9.0}) {
    EXPECT_NEAR(driver.controls(time).steer, 0.05, 1e-15);
    EXPECT_EQ(driver.controls(time).drive_torque, 0.0);
    EXPECT_EQ(driver.controls(time).brake_torque, 1800.0);
  }
}

TEST(TurnBrakingDriver, RefusesBrakesThatAreNone) {
  int looks = 0;
  EXPECT_EQ(why([&] { TurnBrakingDriver(std::make_unique<Restless>(looks), {.brake_time = 5.0}); }),
            "driver: brake_torque is 0; must be > 0");
}

}  // namespace
}  // namespace veridyn::vehicle
