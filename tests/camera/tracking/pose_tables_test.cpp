#include "veridyn/camera/tracking/pose_tables.hpp"

#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace veridyn::camera {
namespace {

TrackedPose seen_at(double time) {
  TrackedPose p{.time = time, .status = TrackStatus::kMeasured};
  PoseMeasurement m{.pose = {1.25, 0.5 + time, -0.3}, .markers = 3};
  m.noise << 1e-6, 1e-7, 2e-7, 1e-7, 2e-6, 0.0, 2e-7, 0.0, 3e-5;
  p.measured = m;
  p.pose = m.pose;
  p.covariance = 2.0 * m.noise;
  return p;
}

TEST(PoseTables, ReadBackToTheSameNumbers) {
  const std::vector<TrackedPose> poses{seen_at(0.1), {.time = 0.15}, seen_at(0.2)};
  const std::vector<TimedPose> measured = parse_poses(measured_poses_csv(poses), "p.csv");
  ASSERT_EQ(measured.size(), 2U);
  EXPECT_EQ(measured[1].time, 0.2);
  EXPECT_EQ(measured[1].pose, poses[2].pose);
  EXPECT_EQ(measured[1].covariance, poses[2].measured->noise);
  const std::vector<TimedPose> filtered = parse_poses(poses_csv(poses), "p.csv");
  ASSERT_EQ(filtered.size(), 2U);
  EXPECT_EQ(filtered[0].covariance, poses[0].covariance);
}

TEST(PoseTables, RefuseRowsThatAreNoPose) {
  const std::string header =
      "time[s],x[m],y[m],heading[deg],cov_xx,cov_xy,cov_xh,cov_yy,cov_yh,cov_hh\n1,0,0,0,1,0,0,1,0,1\n";
  const auto refusal = [&](const std::string& row) { return why([&] { (void)parse_poses(header + row, "p.csv"); }); };
  EXPECT_EQ(refusal("1,0,0,0,1,0,0,1,0,1\n"), "p.csv:3: its time 1 s does not follow 1 s");
  EXPECT_EQ(refusal("2,,0,0,1,0,0,1,0,1\n"), "p.csv:3: a cell is missing or not a finite number");
  EXPECT_EQ(refusal("2,0,0,0,1,2,0,1,0,1\n"), "p.csv:3: its covariance is not positive definite");
  EXPECT_NEAR(parse_poses(header + "2,0,0,180,1,0,0,1,0,1\n", "p.csv")[1].pose(2), 3.14159265358979, 1e-12);
}

}  // namespace
}  // namespace veridyn::camera
