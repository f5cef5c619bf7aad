#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/folders.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::vehicle {
namespace {

std::filesystem::path study_file(const char* name) {
  return test::source_folder() / "examples/studies/vehicle/real" / name;
}

bool data_is_there() { return std::filesystem::exists(test::shared_folder() / "data/vehicle"); }

TEST(RealDrives, ADriveWithoutSteeringIsRefusedByName) {
  if (!data_is_there()) GTEST_SKIP() << "the shared data are not here";
  Progress silent;
  const Study study = Study::load(study_file("kalman_balzer82.toml"));
  VehicleStudy drive = read_study(study, silent);
  try {
    static_cast<void>(identify(drive, silent));
    FAIL() << "identified a drive without steering";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("has no steer"), std::string::npos) << e.what();
  }
}

TEST(RealDrives, AMinuteOfFreewayDoesNotGiveTheStiffnesses) {
  if (!data_is_there()) GTEST_SKIP() << "the shared data are not here";
  Progress silent;
  const Study study = Study::load(study_file("comma2k19.toml"));
  VehicleStudy drive = read_study(study, silent);
  const VehicleAnalysis analysis = identify(drive, silent);
  EXPECT_NE(analysis.identification.verdict, estimation::GroupVerdict::kIdentified) << analysis.identification.reason;
  for (const char* name : {"C_f", "C_r", "I_z"}) {
    const auto* p = analysis.estimate.find(name);
    ASSERT_NE(p, nullptr);
    EXPECT_EQ(p->status, estimation::ParameterStatus::kNotExcited) << name;
  }
}

TEST(RealDrives, HunterRunsAreReadWithTheirFrameAndStamps) {
  if (!data_is_there()) GTEST_SKIP() << "the shared data are not here";
  Progress silent;
  const Study study = Study::load(study_file("hunter_se.toml"));
  const VehicleStudy drive = read_study(study, silent);
  ASSERT_EQ(drive.log.runs.size(), 5u);
  ASSERT_EQ(drive.log.holdout_runs.size(), 2u);
  const DriveSignals signals = prepare_drive_signals(drive.log.mapped, drive.signals);
  const DriveSegments segments = find_drive_segments(signals, drive.segments, drive.log.holdout_runs);
  EXPECT_GT(recording::total_s(segments.identification), 200.0);
  EXPECT_GT(recording::total_s(segments.holdout), 150.0);
  for (const TimeSpan& span : segments.identification) EXPECT_LE(span.end, drive.log.holdout_runs.front().begin);
  // Steering left turns left.
  double product = 0.0;
  for (std::size_t k = 0; k < signals.size(); ++k) {
    const double p = signals[DriveSignal::kSteer].value[k] * signals[DriveSignal::kYawRate].value[k];
    if (std::isfinite(p)) product += p;
  }
  EXPECT_GT(product, 0.0);
}

// The bicycle that the study's comment names, over whole runs: it predicts the yaw rate, and bands that know sensors
// alone do not hold a car whose sensors have next to no noise.
TEST(RealDrives, HunterIsDrivenOpenLoopOverWholeRuns) {
  if (!data_is_there()) GTEST_SKIP() << "the shared data are not here";
  Progress silent;
  VehicleStudy drive = read_study(Study::load(study_file("hunter_se.toml")), silent);
  drive.validation.open_loop.times.duration_s = 600.0;
  drive.validation.holdout_only = true;
  estimation::Estimate estimate;
  estimate.covariance = Eigen::MatrixXd::Zero(3, 3);
  for (const auto& [name, value] : {std::pair{"C_f", 12.7}, std::pair{"C_r", 516.0}, std::pair{"I_z", 0.0726}})
    estimate.parameters.push_back({.name = name, .value = value});
  const auto driven = [&] { return validate(drive, estimate, silent); };
  const VehicleAnalysis sure = driven();
  EXPECT_GT(sure.open_loop.forecast_s, 150.0);
  ASSERT_EQ(sure.open_loop.states.size(), 1u) << "no accelerometer is recorded";
  const estimation::OpenLoopState& yaw_rate = sure.open_loop.states[0];
  EXPECT_LT(yaw_rate.normalised_rmse, 0.2);
  EXPECT_LT(yaw_rate.inside, 0.5);
  EXPECT_NEAR(sure.estimate.validation.at("open_loop.yaw_rate").rmse, yaw_rate.fit.rmse, 1e-12);
  const auto horizon =
      std::ranges::find(sure.estimate.evidence, estimation::Check::kOpenLoopHorizon, &estimation::Evidence::check);
  ASSERT_NE(horizon, sure.estimate.evidence.end());
  EXPECT_LT(yaw_rate.held, yaw_rate.windows) << estimation::says(*horizon);
  estimate.fit["yaw_rate.rmse"] = yaw_rate.fit.rmse * kDegree;
  const VehicleAnalysis widened = driven();
  EXPECT_GT(widened.open_loop.states[0].inside, 0.9);
}

}  // namespace
}  // namespace veridyn::vehicle
