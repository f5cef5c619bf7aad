#include "veridyn/camera/tracking/car_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "tests/camera/rendered_drive.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::camera {
namespace {

constexpr double kRate = 30.0;

Eigen::Vector3d off(const Eigen::Vector3d& pose, const Eigen::Vector3d& truth) {
  Eigen::Vector3d d = pose - truth;
  d(2) = numerics::wrap_angle(d(2));
  return d;
}

/// Counts of 95 % bands that hold.
struct Coverage {
  std::size_t held = 0, count = 0;
  void add(double error, double variance) {
    ++count;
    held += std::abs(error) <= 1.959964 * std::sqrt(variance) ? 1 : 0;
  }
  [[nodiscard]] double share() const { return static_cast<double>(held) / static_cast<double>(count); }
};

/// Bands of the frame's own pose and of the filtered one, over rendered drives with all disturbances, each seen by a
/// camera that was calibrated on its own noisy points: shares of frames that hold the truth.
void expect_bands_hold(std::uint64_t drives, double low, double high) {
  Coverage measured[3], filtered[3], hidden[3];
  int wrong = 0, lost = 0, measured_frames = 0, frames = 0;
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= drives; ++seed) {
    const TrackCamera truth = testing::half_size_camera();
    const Calibration calibration = fit_camera(testing::grid_points(truth, 0.2, 0.15, seed));
    OverheadScene scene = testing::disturbed_scene(truth, 960, 540);
    const double start = 3.1 * static_cast<double>(seed);
    scene.pose = [start](double t) { return testing::figure_of_eight(t + start); };
    OverheadRenderer renderer(scene, seed);
    CarTracker tracker(calibration, {});
    for (int k = 0; k < 210; ++k) {
      const double t = k / kRate;
      const TrackedPose p = tracker.add(t, renderer.render(t).view());
      ++frames;
      if (p.status == TrackStatus::kLost) {
        ++lost;
        continue;
      }
      const Eigen::Vector3d error = off(p.pose, scene.pose(t));
      const bool under_bridge = t >= 2.0 && t <= 3.0;
      for (int i = 0; i < 3; ++i) (under_bridge ? hidden : filtered)[i].add(error(i), p.covariance(i, i));
      if (p.measured) {
        EXPECT_FALSE(under_bridge) << "seed " << seed << " t " << t;
        ++measured_frames;
        const Eigen::Vector3d e = off(p.measured->pose, scene.pose(t));
        const Eigen::Matrix3d P = p.measured->covariance();
        for (int i = 0; i < 3; ++i) measured[i].add(e(i), P(i, i));
        squares += e.head<2>().squaredNorm();
        wrong += e.head<2>().norm() > 0.02 ? 1 : 0;
      }
    }
  }
  const char* names[] = {"x", "y", "heading"};
  for (int i = 0; i < 3; ++i) {
    EXPECT_GE(measured[i].share(), low) << names[i];
    EXPECT_LE(measured[i].share(), high) << names[i];
    // Hidden frames are few independent draws: they count with the others.
    filtered[i].held += hidden[i].held;
    filtered[i].count += hidden[i].count;
    EXPECT_GE(hidden[i].share(), low) << names[i];
    EXPECT_GE(filtered[i].share(), low) << names[i];
    EXPECT_LE(filtered[i].share(), high) << names[i];
    ::testing::Test::RecordProperty(std::string(names[i]) + "_bands",
                                    fmt::format("{:.3f} measured, {:.3f} filtered, {:.3f} hidden", measured[i].share(),
                                                filtered[i].share(), hidden[i].share()));
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_LT(lost, static_cast<int>(drives) * 4) << "the car is found at the start and again when the bridge ends";
  ::testing::Test::RecordProperty("frames",
                                  fmt::format("{}, {} measured, {} lost, rms {:.3f} mm", frames, measured_frames, lost,
                                              1e3 * std::sqrt(squares / measured_frames)));
}

// Errors of a camera's calibration are common to its frames: three drives scatter more than twelve.
TEST(CarTracker, BandsHoldOnRenderedVideoWithAllDisturbances) { expect_bands_hold(3, 0.88, 0.99); }

TEST(CarTrackerSoak, BandsHoldOnTwelveRenderedDrives) { expect_bands_hold(12, 0.90, 0.98); }

/// Spots where the markers of a car at a pose are, without noise.
std::vector<Blob> markers_at(const TrackCamera& camera, const Eigen::Vector3d& pose, const MarkerLayout& layout) {
  std::vector<Blob> blobs;
  for (const Eigen::Vector2d& m : layout.markers) {
    Blob blob;
    const double c = std::cos(pose(2)), s = std::sin(pose(2));
    blob.centre = *camera.to_image({pose(0) + c * m(0) - s * m(1), pose(1) + s * m(0) + c * m(1)});
    blob.covariance = 0.01 * Eigen::Matrix2d::Identity();
    blobs.push_back(blob);
  }
  return blobs;
}

Calibration known_camera() { return fit_camera(testing::grid_points(testing::wide_camera(), 0.2, 0.1, 3)); }

TEST(CarTracker, FindsPoseVelocityAndYawRateOnACircle) {
  const TrackCamera camera = testing::wide_camera();
  Calibration calibration = known_camera();
  CarTracker tracker(calibration, {});
  TrackedPose p;
  const double radius = 0.8, yaw_rate = 2.0;
  for (int k = 0; k <= 90; ++k) {
    const double t = k / kRate, angle = yaw_rate * t;
    const Eigen::Vector3d pose(2.2 + radius * std::sin(angle), 1.2 - radius * std::cos(angle), angle);
    p = tracker.add(t, markers_at(camera, pose, {}));
    ASSERT_EQ(p.status, TrackStatus::kMeasured) << t;
    EXPECT_LT(off(p.pose, pose).head<2>().norm(), 1e-3);
  }
  EXPECT_NEAR(p.velocity(0), radius * yaw_rate, 0.01);
  EXPECT_NEAR(p.velocity(1), 0.0, 0.01);
  EXPECT_NEAR(p.velocity(2), yaw_rate, 0.02);
}

TEST(CarTracker, TwoMarkersNeedAHeadingAndKeepIt) {
  TrackerOptions options;
  options.layout.markers = {{0.1, 0.0}, {-0.1, 0.0}};
  EXPECT_EQ(why([&] { CarTracker(known_camera(), options); }),
            "tracker: two markers look the same from both ends: the heading at the start must be given");
  for (const double heading : {0.3, 0.3 + kPi}) {
    options.first_heading = heading + 0.5;
    CarTracker tracker(known_camera(), options);
    for (int k = 0; k < 20; ++k) {
      const double t = k / kRate, h = heading + 1.5 * t;
      const Eigen::Vector3d pose(2.0 + 0.5 * t, 1.0, h);
      const TrackedPose p = tracker.add(t, markers_at(testing::wide_camera(), pose, options.layout));
      ASSERT_EQ(p.status, TrackStatus::kMeasured);
      EXPECT_LT(std::abs(numerics::wrap_angle(p.pose(2) - h)), 0.01);
    }
  }
}

TEST(CarTracker, TakesNoFirstPoseOfTwoThatAreAsGood) {
  const TrackCamera camera = testing::wide_camera();
  CarTracker tracker(known_camera(), {});
  std::vector<Blob> both = markers_at(camera, {1.0, 1.0, 0.2}, {});
  const std::vector<Blob> other = markers_at(camera, {3.0, 1.5, 2.0}, {});
  both.insert(both.end(), other.begin(), other.end());
  EXPECT_EQ(tracker.add(0.0, both).status, TrackStatus::kLost);
  EXPECT_EQ(tracker.add(0.1, std::span(both).first(3)).status, TrackStatus::kMeasured);
  // The same two cars, now that one is known.
  EXPECT_EQ(tracker.add(0.2, both).status, TrackStatus::kMeasured);
}

TEST(CarTracker, ALongBreakLosesTheCar) {
  const std::vector<Blob> seen = markers_at(testing::wide_camera(), {1.0, 1.0, 0.2}, {});
  CarTracker tracker(known_camera(), {});
  EXPECT_EQ(tracker.add(0.0, seen).status, TrackStatus::kMeasured);
  EXPECT_EQ(tracker.add(0.1, std::span<const Blob>()).status, TrackStatus::kPredicted);
  EXPECT_EQ(tracker.add(5.0, std::span<const Blob>()).status, TrackStatus::kLost);
  EXPECT_EQ(tracker.add(5.1, seen).status, TrackStatus::kMeasured);
}

TEST(CarTracker, RefusesWhatItCannotUse) {
  CarTracker tracker(known_camera(), {});
  (void)tracker.add(1.0, std::span<const Blob>());
  EXPECT_EQ(why([&] { (void)tracker.add(1.0, std::span<const Blob>()); }),
            "frame: its time 1.000000 s does not follow 1.000000 s");
  EXPECT_NE(why([&] { (void)tracker.add(kNaN, std::span<const Blob>()); }).find("does not follow"), std::string::npos);
  TrackerOptions options;
  options.layout.markers = {{0.1, 0.0}, {-0.1, 0.05}, {-0.1, -0.05}};
  EXPECT_NE(why([&] { CarTracker(known_camera(), options); }).find("distinguishable"), std::string::npos);
  Calibration four = known_camera();
  four.covariance.setConstant(kNaN);
  EXPECT_NE(why([&] { CarTracker(four, {}); }).find("calibration: its error is unknown"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::camera
