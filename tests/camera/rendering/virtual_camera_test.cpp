#include "veridyn/camera/rendering/virtual_camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/camera/tracking/car_tracker.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::camera {
namespace {

using ::testing::HasSubstr;

/// Once around in 8 s, 4 m across, turning its head as it goes.
Eigen::Vector3d around(double t) {
  const double a = 2.0 * kPi * t / 8.0;
  return {4.0 * std::cos(a), 3.0 * std::sin(a), std::remainder(a + 0.5 * kPi, 2.0 * kPi)};
}

MarkerLayout wide_markers() { return {.markers = {{0.20, 0.0}, {-0.16, 0.10}, {-0.12, -0.08}}}; }

// The tracker knows the calibration that was fitted to points, not the lens: its errors are as large as it says.
TEST(VirtualCamera, SeesTheCarWhereItIs) {
  const VirtualCameraOptions options{.x = {-6.0, 6.0}, .y = {-4.0, 4.0}, .width = 960, .height = 640};
  VirtualCamera camera(options, wide_markers(), 3);
  CarTracker tracker(camera.calibration(), {.layout = wide_markers()});
  std::size_t seen = 0, pictures = 0;
  double squares = 0.0;
  for (double t = 0.0; t < 4.0; t += 0.01) {
    camera.place(t, around(t));
    const double at = static_cast<double>(pictures) / options.rate_Hz + 0.05;
    if (!camera.knows(at)) continue;
    ++pictures;
    const TrackedPose pose = tracker.add(at, camera.picture(at).view());
    if (!pose.measured) continue;
    ++seen;
    Eigen::Vector3d off = pose.measured->pose - around(at);
    off(2) = std::remainder(off(2), 2.0 * kPi);
    EXPECT_LT(off.head<2>().norm(), 0.01) << at;
    squares += off.dot(pose.measured->covariance().ldlt().solve(off));
  }
  EXPECT_GT(pictures, 110U);
  EXPECT_GT(seen, pictures - 5);
  // Chi-square of three degrees of freedom each; the map's error is one for all of them.
  const double mean = squares / static_cast<double>(seen);
  EXPECT_GT(mean, 1.0);
  EXPECT_LT(mean, 6.0);
}

TEST(VirtualCamera, KnowsOnlyWhatItWasTold) {
  VirtualCamera camera({}, wide_markers(), 1);
  EXPECT_FALSE(camera.knows(1.0));
  camera.place(1.0, around(1.0));
  EXPECT_FALSE(camera.knows(1.0)) << "half of the exposure lies after it";
  camera.place(1.1, around(1.1));
  EXPECT_TRUE(camera.knows(1.05));
  EXPECT_FALSE(camera.knows(1.1));
  EXPECT_FALSE(camera.knows(0.9));
  camera.place(5.0, around(5.0));
  EXPECT_FALSE(camera.knows(1.05)) << "too long ago";
}

TEST(VirtualCamera, IsRefusedWhereItCouldNotTellTheMarkers) {
  EXPECT_THAT(
      why([] {
        VirtualCamera({.x = {-50.0, 50.0}}, wide_markers(), 1);
      }),
      HasSubstr(
          "live.camera.view: on a picture of 1920 x 1080 px of 100 x 10 m the car's markers are 3.2 px apart; must "
          "be at least 12"));
  const auto read = [](const std::string& text) {
    return VirtualCameraOptions::keys().read(Study::parse(text, "rig.toml").root());
  };
  const VirtualCameraOptions o = read("x = [\"-3 m\", \"400 cm\"]\nwidth = 800\nheight = 600\nrate = \"25 Hz\"\n");
  EXPECT_EQ(o.x[0], -3.0);
  EXPECT_EQ(o.x[1], 4.0);
  EXPECT_EQ(o.width, 800);
  EXPECT_EQ(o.rate_Hz, 25.0);
  EXPECT_THAT(why([&] { (void)read("x = [3, -3]\n"); }), HasSubstr("rig.toml:1: x: must be two numbers"));
  EXPECT_THAT(why([&] { (void)read("width = 10\n"); }), HasSubstr("= 10 must be from 64 to 8192"));
  EXPECT_THAT(why([&] { (void)read("rate = 30\nexposure = \"50 ms\"\n"); }), HasSubstr("exposure: = 0.05 s"));
}

}  // namespace
}  // namespace veridyn::camera
