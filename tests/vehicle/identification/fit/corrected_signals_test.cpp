#include "veridyn/vehicle/identification/fit/corrected_signals.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/identification/options/drive_unknown.hpp"

namespace veridyn::vehicle {
namespace {

constexpr double kGridStep = 0.01;

/// sin(2 t - phase) on the grid.
std::vector<double> wave(double late_s) {
  std::vector<double> out;
  for (int k = 0; k < 500; ++k) out.push_back(std::sin(2.0 * (k * kGridStep - late_s)));
  return out;
}

TEST(CorrectedSignals, AreInTheTimeOfTheWheelsAndAtTheAccelerometersPlace) {
  DriveSignals recorded;
  recorded.grid = {.begin = 0.0, .step = kGridStep, .count = 500};
  recorded.accel_position = {0.2, 0.0, 0.1};
  recorded[DriveSignal::kSteer].value = wave(0.025);  // late, so that the wheels answer it early
  recorded[DriveSignal::kYawRate].value = wave(0.0);
  recorded[DriveSignal::kAccelY].value = wave(0.013);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(kDriveUnknowns);
  theta(static_cast<Eigen::Index>(DriveUnknown::kSteerDelay)) = -0.025;
  theta(static_cast<Eigen::Index>(DriveUnknown::kAccelYDelay)) = 0.013;
  theta(static_cast<Eigen::Index>(DriveUnknown::kAccelPlace)) = 0.4;
  theta(static_cast<Eigen::Index>(DriveUnknown::kAccelHeight)) = -0.3;
  const DriveSignals corrected = corrected_signals(recorded, theta);
  const std::vector<double> in_time = wave(0.0);
  for (std::size_t k = 10; k < 490; ++k) {
    EXPECT_NEAR(corrected[DriveSignal::kSteer].value[k], in_time[k], 1e-5);
    EXPECT_NEAR(corrected[DriveSignal::kAccelY].value[k], in_time[k], 1e-5);
    EXPECT_EQ(corrected[DriveSignal::kYawRate].value[k], in_time[k]);
  }
  EXPECT_DOUBLE_EQ(corrected.accel_position[0], 0.6);
  EXPECT_DOUBLE_EQ(corrected.accel_position[2], -0.2);
}

// A shift brings a gap, or what lies beyond the recording, to where something was recorded.
TEST(CorrectedSignals, LeaveNoSampleWithoutAValueThatHadOne) {
  DriveSignals recorded;
  recorded.grid = {.begin = 0.0, .step = kGridStep, .count = 500};
  recorded[DriveSignal::kSteer].value = wave(0.025);
  for (std::size_t k = 200; k < 220; ++k) recorded[DriveSignal::kSteer].value[k] = kNaN;
  recorded[DriveSignal::kSteer].value.back() = kNaN;
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(kDriveUnknowns);
  for (const double delay : {-0.025, 0.025}) {
    theta(static_cast<Eigen::Index>(DriveUnknown::kSteerDelay)) = delay;
    const std::vector<double>& before = recorded[DriveSignal::kSteer].value;
    const DriveSignals corrected = corrected_signals(recorded, theta);
    const std::vector<double>& after = corrected[DriveSignal::kSteer].value;
    for (std::size_t k = 0; k < 500; ++k) {
      EXPECT_EQ(std::isfinite(after[k]), std::isfinite(before[k])) << k;
      // 2 rad/s over the whole shift, at most.
      if (std::isfinite(after[k])) EXPECT_NEAR(after[k], before[k], 2.0 * 0.03) << k;
    }
  }
}

}  // namespace
}  // namespace veridyn::vehicle
