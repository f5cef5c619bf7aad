#include "veridyn/vehicle/identification/evidence/drive_consistency.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace veridyn::vehicle {
namespace {

// Where no single sensor explains what is off, all that might be are named; where none does, each by itself.
TEST(Culprits, AreTheSensorsThatExplainAllThatIsOff) {
  const estimation::Tolerance tolerance = estimation::Tolerance::about(1.0, 0.05, 0.2);
  const auto relation = [&](DriveSuspect sensor, double ratio, const PerDriveSuspect<int>& power) {
    return DriveRelation{.sensor = sensor,
                         .low = ratio - 0.01,
                         .high = ratio + 0.01,
                         .strong = true,
                         .verified = std::abs(ratio - 1.0) < 0.05,
                         .power = power,
                         .tolerance = tolerance};
  };
  const auto turning = [&](double ratio) { return relation(DriveSuspect::kAccelY, ratio, {0, -1, -1, 1, 0}); };
  const auto steering = [&](double ratio) { return relation(DriveSuspect::kSteer, ratio, {1, 1, -1, 0, 0}); };
  const auto sensors = [](const std::vector<DriveCulprit>& found) {
    std::vector<DriveSuspect> names;
    for (const DriveCulprit& c : found) names.push_back(c.sensor);
    return names;
  };
  EXPECT_TRUE(culprits(std::vector{turning(1.0), steering(1.0)}).empty());
  EXPECT_THAT(sensors(culprits(std::vector{turning(1.25)})),
              ::testing::ElementsAre(DriveSuspect::kSpeed, DriveSuspect::kYawRate, DriveSuspect::kAccelY));
  EXPECT_THAT(sensors(culprits(std::vector{turning(1.25), steering(1.0)})),
              ::testing::ElementsAre(DriveSuspect::kAccelY));
  EXPECT_THAT(sensors(culprits(std::vector{turning(1.0), steering(1.25)})),
              ::testing::ElementsAre(DriveSuspect::kSteer));
  const auto gyro = culprits(std::vector{turning(1.25), steering(1.25)});
  ASSERT_THAT(sensors(gyro), ::testing::ElementsAre(DriveSuspect::kYawRate));
  EXPECT_NEAR(gyro.front().factor, 0.8, 1e-9);
  EXPECT_THAT(sensors(culprits(std::vector{turning(1.25), steering(0.8)})),
              ::testing::ElementsAre(DriveSuspect::kSpeed));
  EXPECT_TRUE(culprits(std::vector{turning(1.25), steering(0.5)}).empty());
}

}  // namespace
}  // namespace veridyn::vehicle
