#include "veridyn/camera/fusion/fused_drive.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/camera/fusion/simulated_sensors.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::camera {
namespace {

TEST(FusedDrive, IsThatOfTheTablesOfADrive) {
  const testing::SimulatedRun run = testing::simulated_run({.seed = 2, .duration_s = 25.0, .offset = 0.04});
  std::string inertial = "time[s],rate_x[deg/s],rate_y[rad/s],rate_z[rad/s],force_x[m/s^2],force_y[m/s^2],force_z[g]\n";
  for (const testing::InertialSample& s : run.inertial)
    inertial += fmt::format("{},{},{},{},{},{},{}\n", s.time, s.rate(0) / kDegree, s.rate(1), s.rate(2), s.force(0),
                            s.force(1), s.force(2) / kGravity);
  std::vector<TimedPose> poses;
  for (const testing::CameraSample& f : run.frames) poses.push_back({f.stamp, f.pose, f.covariance});
  std::sort(poses.begin(), poses.end(), [](const TimedPose& a, const TimedPose& b) { return a.time < b.time; });
  const std::vector<InertialReading> readings = parse_inertial(inertial, "inertial.csv");
  ASSERT_EQ(readings.size(), run.inertial.size());
  EXPECT_NEAR(readings[7].force(2), run.inertial[7].force(2), 1e-12);
  const FusedDrive drive = fuse(readings, poses, {});
  EXPECT_EQ(drive.frames + drive.left_out, poses.size());
  EXPECT_LT(drive.left_out, 5U);
  EXPECT_EQ(drive.gaps, 0U);
  EXPECT_NEAR(drive.motion.back().offset, 0.04, 5e-3);
  EXPECT_NEAR(drive.motion.back().pitch, run.truth.back().pitch, 2.0 * kDegree);
  const std::string csv = to_csv(drive.motion);
  EXPECT_EQ(csv.substr(0, 31), "time[s],x[m],y[m],velocity_x[m/");
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), drive.motion.size() + 1);
}

TEST(FusedDrive, RefusesWhatItCannotRead) {
  const std::string header =
      "time[s],rate_x[rad/s],rate_y[rad/s],rate_z[rad/s],force_x[m/s^2],force_y[m/s^2],force_z[m/s^2]\n";
  const auto refusal = [](const std::string& text) { return why([&] { (void)parse_inertial(text, "i.csv"); }); };
  EXPECT_EQ(refusal(header + "0,0,0,0,0,0,9.8\n0,0,0,0,0,0,9.8\n"), "i.csv:3: its time 0 s does not follow 0 s");
  EXPECT_EQ(refusal(header + "0,0,0,0,0,0,\n"), "i.csv:2: a cell is missing or not a finite number");
  EXPECT_EQ(refusal("time[s],rate_x,rate_y,rate_z,force_x,force_y,force_z\n0,0,0,0,0,0,9.8\n"),
            "i.csv: column 'rate_x' is in 1; must be in rad/s, as rate_x[rad/s]");
  const std::vector<InertialReading> one = parse_inertial(header + "0,0,0,0,0,0,9.8\n", "i.csv");
  EXPECT_EQ(why([&] { (void)fuse(one, {}, {}); }),
            "fusion: the inertial sensors and the poses of the camera have no time in common");
}

}  // namespace
}  // namespace veridyn::camera
