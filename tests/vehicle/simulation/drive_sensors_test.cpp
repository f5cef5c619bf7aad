#include "veridyn/vehicle/simulation/drive_sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/vehicle/changed_drive.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using testing::lively_drive;
using testing::prepared;

TEST(DriveSensors, TheRecordedNoiseIsTheOneAsked) {
  const Recording r = record_drive(lively_drive(family_car(), 1, 0.02, 120.0), reference_drive_sensors(), 3);
  const DriveSignals s = prepared(r);
  // 12000 samples: the level is found to a few percent.
  EXPECT_NEAR(s[DriveSignal::kYawRate].sigma, 0.1 * M_PI / 180.0, 0.15 * 0.1 * M_PI / 180.0);
  EXPECT_NEAR(s[DriveSignal::kAccelY].sigma, 0.05, 0.0075);
  EXPECT_EQ(r.frame, Frame::kFlu);
  const Recording again = record_drive(lively_drive(family_car(), 1, 0.02, 120.0), reference_drive_sensors(), 3);
  EXPECT_EQ(r.at("accel_y").value, again.at("accel_y").value);
}

TEST(DriveSensors, AnAccelerometerAwayFromTheCentreOfGravityIsMovedThere) {
  const VehicleTrajectory t = lively_drive(family_car(), 1, 0.02, 30.0);
  DriveSensorSet sensors = testing::perfect_sensors();
  sensors.accel_position = {0.8, 0.3, 0.0};
  const DriveSignals s = prepared(record_drive(t, sensors, 1), {.accel_position = {0.8, 0.3, 0.0}});
  for (std::size_t k = 0; k < s.size(); k += 100) {
    const double expected = t.lateral_acceleration[k] + 0.8 * t.yaw_acceleration[k] - 0.3 * t.r[k] * t.r[k];
    EXPECT_NEAR(s[DriveSignal::kAccelY].value[k], expected, 1e-9);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
