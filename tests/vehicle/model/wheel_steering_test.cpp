#include "veridyn/vehicle/model/wheel_steering.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::vehicle {
namespace {

TEST(ControlsAtWheels, TurnTheFrontWheelsAlikeWithoutAckermann) {
  const VehicleParameters<double> p;
  const WheelControls<double> c = controls_at_wheels(p, {}, 0.2, 500.0, 300.0);
  EXPECT_TRUE((c.steer == WheelArray<double>(0.2, 0.2, 0.0, 0.0)).all());
  EXPECT_NEAR(c.cos[0], std::cos(0.2), 1e-15);
  EXPECT_NEAR(c.sin[1], std::sin(0.2), 1e-15);
  EXPECT_EQ(c.cos[2], 1.0);
  EXPECT_EQ(c.sin[3], 0.0);
  EXPECT_TRUE((c.drive == 0.0).all()) << "without longitudinal dynamics";
  EXPECT_TRUE((c.brake == 0.0).all());
}

// With all of Ackermann's geometry the axes of both front wheels meet on the line of the rear axle.
TEST(ControlsAtWheels, TurnAboutACommonCentreWithAckermann) {
  const VehicleParameters<double> p;
  FourWheelOptions options;
  options.ackermann = 1.0;
  for (const double steer : {0.3, -0.3}) {
    const WheelControls<double> c = controls_at_wheels(p, options, steer, 0.0, 0.0);
    const double centre_of_left = 0.5 * p.track_f + p.wheelbase() / std::tan(c.steer[0]);
    const double centre_of_right = -0.5 * p.track_f + p.wheelbase() / std::tan(c.steer[1]);
    EXPECT_NEAR(centre_of_left, p.wheelbase() / std::tan(steer), 1e-12);
    EXPECT_NEAR(centre_of_right, centre_of_left, 1e-12);
    EXPECT_NEAR(c.sin[0], std::sin(c.steer[0]), 1e-15);
  }
}

TEST(ControlsAtWheels, DivideTorquesBetweenTheAxles) {
  const VehicleParameters<double> p;
  FourWheelOptions options;
  options.longitudinal.emplace();
  options.longitudinal->front_drive_share = 0.25;
  options.longitudinal->front_brake_share = 0.75;
  const WheelControls<double> c = controls_at_wheels(p, options, 0.0, 800.0, 400.0);
  EXPECT_TRUE((c.drive == WheelArray<double>(100.0, 100.0, 300.0, 300.0)).all());
  EXPECT_TRUE((c.brake == WheelArray<double>(150.0, 150.0, 50.0, 50.0)).all());
}

TEST(ControlsAtWheels, LeaveForcesWhereTheyAreWithSmallAngles) {
  const VehicleParameters<double> p;
  FourWheelOptions options;
  options.geometry = BicycleGeometry::kSmallAngles;
  const WheelControls<double> c = controls_at_wheels(p, options, 0.2, 0.0, 0.0);
  EXPECT_EQ(c.steer[0], 0.2);
  EXPECT_TRUE((c.cos == 1.0).all());
  EXPECT_TRUE((c.sin == 0.0).all());
}

}  // namespace
}  // namespace veridyn::vehicle
