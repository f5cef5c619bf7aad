#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"
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

}  // namespace
}  // namespace veridyn::vehicle
