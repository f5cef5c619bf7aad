#include "veridyn/vehicle/identification/signals/drive_path.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle {
namespace {

constexpr double kPathStep_s = 0.01;
constexpr std::size_t kPathSamples = 3001, kPathStart = 200;

/// Signals of a drive at 20 m/s that record nothing yet.
DriveSignals drive_without_records() {
  DriveSignals signals;
  signals.grid = {.begin = 5.0, .step = kPathStep_s, .count = kPathSamples};
  signals[DriveSignal::kSpeed].value.assign(kPathSamples, 20.0);
  for (const DriveSignal s : {DriveSignal::kX, DriveSignal::kY, DriveSignal::kYaw})
    signals[s].value.assign(kPathSamples, kNaN);
  return signals;
}

SimulatedTurning steady_turning(double yaw_rate, double lateral_velocity) {
  return {.first = 0,
          .forecast_from = kPathStart,
          .yaw_rate = std::vector<double>(kPathSamples, yaw_rate),
          .lateral_velocity = std::vector<double>(kPathSamples, lateral_velocity)};
}

void record_place(DriveSignals& signals, std::size_t k, double x, double y, double yaw) {
  signals[DriveSignal::kX].value[k] = x;
  signals[DriveSignal::kY].value[k] = y;
  signals[DriveSignal::kYaw].value[k] = yaw;
}

TEST(DrivePath, OfASteadyTurnIsItsCircleWhereverItBeganAndWhicheverWay) {
  // Speed 20 m/s and 1.5 m/s sideways: the circle's radius is their sum's, and it points ahead of the course.
  constexpr double r = 0.25, v = 1.5, first_heading = 2.2, sensor_offset = 0.4;
  const double radius = std::hypot(20.0, v) / r, sideslip = std::atan2(v, 20.0);
  DriveSignals signals = drive_without_records();
  for (std::size_t k = 0; k < kPathSamples; ++k) {
    const double psi = first_heading + r * kPathStep_s * static_cast<double>(k), course = psi + sideslip;
    record_place(signals, k, -70.0 + radius * std::sin(course), 40.0 - radius * std::cos(course), psi + sensor_offset);
  }
  const SimulatedTurning motion = steady_turning(r, v);
  const DrivePath path = drive_path(signals, {&motion, 1});
  ASSERT_TRUE(path.heading && path.position);
  EXPECT_LT(path.heading->rmse, 1e-10) << "the offset of a heading's sensor is in where it begins";
  EXPECT_LT(path.position->rmse, 1e-3);
  EXPECT_NEAR(path.distance_m, std::hypot(20.0, v) * 28.0, 0.01);
  EXPECT_EQ(path.time.size(), kPathSamples + 1) << "and a gap";
}

TEST(DrivePath, SaysHowFarTheModelIsOffAndHowMuchOfThatIsAcross) {
  // Straight on; after the start the car is 1 m to the left, turned by 2 deg, and 3 % faster than its speed says.
  DriveSignals signals = drive_without_records();
  for (std::size_t k = 0; k < kPathSamples; ++k) {
    const bool start = k < kPathStart;
    const double way = 20.0 * kPathStep_s * static_cast<double>(k);
    const double begun = 20.0 * kPathStep_s * static_cast<double>(kPathStart);
    record_place(signals, k, start ? way : begun + 1.03 * (way - begun), start ? 0.0 : 1.0,
                 start ? 0.0 : 2.0 * kDegree);
  }
  const SimulatedTurning motion = steady_turning(0.0, 0.0);
  const DrivePath path = drive_path(signals, {&motion, 1});
  EXPECT_NEAR(path.heading->rmse, 2.0 * kDegree, 1e-9);
  EXPECT_NEAR(path.across_rmse, 1.0, 1e-9);
  const double along = 0.03 * 20.0 * 28.0;
  EXPECT_NEAR(path.position->at_end, std::hypot(1.0, along), 1e-6);
  EXPECT_NEAR(path.position->rmse, std::sqrt(1.0 + along * along / 3.0), 0.02) << "it grows in proportion to the way";
}

TEST(DrivePath, IsNotScoredWhereNothingWasRecordedOrNothingTellsWhichWayItBegan) {
  DriveSignals signals = drive_without_records();
  const SimulatedTurning motion = steady_turning(0.1, 0.0);
  EXPECT_FALSE(drive_path(signals, {&motion, 1}).available()) << "no numbers";
  signals[DriveSignal::kYaw].value.assign(kPathSamples, 0.3);
  signals[DriveSignal::kX].value.assign(kPathSamples, 1.0);
  signals[DriveSignal::kY].value.assign(kPathSamples, 2.0);
  signals[DriveSignal::kSpeed].value.assign(kPathSamples, 0.1);
  const DrivePath standing = drive_path(signals, {&motion, 1});
  EXPECT_TRUE(standing.heading.has_value());
  EXPECT_FALSE(standing.position.has_value()) << "20 cm";
  DriveSignals nothing = drive_without_records();
  for (const DriveSignal s : {DriveSignal::kX, DriveSignal::kY, DriveSignal::kYaw}) nothing[s].value.clear();
  EXPECT_FALSE(drive_path(nothing, {&motion, 1}).available());
  EXPECT_FALSE(drive_path(signals, {}).available());
}

TEST(DrivePath, LeavesOutWhatWasNotRecorded) {
  DriveSignals signals = drive_without_records();
  // Positions once in ten samples, as of a receiver of 10 Hz.
  for (std::size_t k = 0; k < kPathSamples; k += 10) record_place(signals, k, 0.2 * static_cast<double>(k), 3.0, kNaN);
  const SimulatedTurning motion = steady_turning(0.0, 0.0);
  const DrivePath path = drive_path(signals, {&motion, 1});
  EXPECT_FALSE(path.heading.has_value());
  ASSERT_TRUE(path.position.has_value());
  EXPECT_EQ(path.position->samples, 281U);
  EXPECT_LT(path.position->rmse, 1e-9);
  estimation::Estimate estimate;
  add_path(path, estimate);
  EXPECT_EQ(estimate.fit.count("open_loop.position.at_end"), 1U);
  EXPECT_EQ(estimate.fit.count("open_loop.yaw.rmse"), 0U);
}

}  // namespace
}  // namespace veridyn::vehicle
