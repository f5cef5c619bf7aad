#include "veridyn/camera/tracking/silhouette.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/camera/rendered_drive.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/sanitized.hpp"
#include "veridyn/camera/tracking/car_tracker.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::camera {
namespace {

/// A car without markers but brighter than the track, in a room whose light flickers, hidden for a second.
OverheadScene plain_scene(const TrackCamera& camera) {
  OverheadScene scene{.camera = camera, .width = 960, .height = 540, .pose = testing::figure_of_eight};
  scene.car = 90.0;
  // The track is empty in the first picture.
  scene.hidden = {{-1.0, 0.1}, {3.0, 4.0}};
  scene.room_light = [](double t) { return 1.0 + 0.25 * std::sin(2.0 * kPi * 8.7 * t); };
  return scene;
}

TEST(SilhouetteFinder, FollowsACarWithoutMarkers) {
  const TrackCamera truth = testing::half_size_camera();
  const std::uint64_t drives = test::kSanitized ? 1 : 4;
  std::size_t held[3] = {}, count = 0, hidden = 0;
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= drives; ++seed) {
    const Calibration calibration = fit_camera(testing::grid_points(truth, 0.2, 0.15, seed));
    OverheadScene scene = plain_scene(truth);
    const double start = 2.3 * static_cast<double>(seed);
    scene.pose = [start](double t) { return testing::figure_of_eight(t + start); };
    OverheadRenderer renderer(scene, seed);
    SilhouetteFinder finder{SilhouetteOptions{}};
    TrackerOptions options;
    options.first_heading = scene.pose(0.1)(2) + 0.5;
    CarTracker tracker(calibration, options);
    for (int k = 0; k < 180; ++k) {
      const double t = k / 30.0;
      const TrackedPose p = tracker.add(t, finder.find(renderer.render(t).view(), calibration));
      if (t > 3.0 && t < 4.0) hidden += p.measured ? 1 : 0;
      if (!p.measured) continue;
      ++count;
      Eigen::Vector3d off = p.measured->pose - scene.pose(t);
      off(2) = numerics::wrap_angle(off(2));
      EXPECT_LT(off.head<2>().norm(), 0.01) << "seed " << seed << " t " << t;
      EXPECT_LT(std::abs(off(2)), 0.1) << "seed " << seed << " t " << t;
      squares += off.head<2>().squaredNorm();
      const Eigen::Matrix3d P = p.measured->covariance();
      for (int i = 0; i < 3; ++i) held[i] += std::abs(off(i)) <= 1.96 * std::sqrt(P(i, i)) ? 1 : 0;
    }
  }
  EXPECT_EQ(hidden, 0U);
  EXPECT_GT(count, drives * 100);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(count)), 0.5e-3);
  // The error of an edge is a cautious guess, not measured as with markers: at least the bands shall not be too narrow.
  std::string shares;
  for (const std::size_t h : held) {
    const double share = static_cast<double>(h) / static_cast<double>(count);
    EXPECT_GE(share, 0.90);
    shares += fmt::format("{:.3f} ", share);
  }
  RecordProperty("silhouette", fmt::format("{} frames, rms {:.3f} mm, bands {}", count,
                                           1e3 * std::sqrt(squares / static_cast<double>(count)), shares));
}

TEST(SilhouetteFinder, RefusesWhatItCannotUse) {
  SilhouetteOptions options;
  options.width = options.length;
  EXPECT_NE(why([&] { SilhouetteFinder{options}; }).find("1.2 times as long as wide"), std::string::npos);
  SilhouetteFinder finder{SilhouetteOptions{}};
  const Calibration calibration = fit_camera(testing::grid_points(testing::half_size_camera(), 0.4, 0.1, 1));
  const GreyImage first{.width = 64, .height = 48, .pixels = std::vector<std::uint8_t>(64 * 48, 20)};
  const GreyImage second{.width = 48, .height = 64, .pixels = std::vector<std::uint8_t>(64 * 48, 20)};
  EXPECT_TRUE(finder.find(first.view(), calibration).empty());
  EXPECT_TRUE(finder.find(first.view(), calibration).empty());
  EXPECT_EQ(why([&] { (void)finder.find(second.view(), calibration); }), "frame: is 48 x 64 px, the first was 64 x 48");
}

}  // namespace
}  // namespace veridyn::camera
