#include "veridyn/camera/calibration/track_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/camera/synthetic_camera.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::camera {
namespace {

TEST(TrackCamera, GoesThereAndBackToANanometre) {
  for (const auto& [k1, k2] :
       {std::pair{-0.05, 0.01}, {-0.2, 0.0}, {0.1, 0.05}, {0.0, 0.0}, {0.0, -0.02}, {-0.3, 0.1}}) {
    const TrackCamera camera = testing::wide_camera(k1, k2);
    int seen = 0;
    for (double x = -0.5; x < 5.0; x += 0.07) {
      for (double y = -0.5; y < 3.0; y += 0.07) {
        const auto image = camera.to_image({x, y});
        if (!image) continue;
        const auto back = camera.to_track(*image);
        ASSERT_TRUE(back) << x << " " << y << " k1 " << k1;
        // Near the fold the inverse is as badly conditioned as the fold is near.
        if ((*image - Eigen::Vector2d(970.0, 530.0)).norm() < 0.9 * camera.folding_radius()) {
          EXPECT_LT((*back - Eigen::Vector2d(x, y)).norm(), 1e-9) << x << " " << y << " k1 " << k1;
        }
        ++seen;
      }
    }
    EXPECT_GT(seen, 2500);  // of 3950, most of which this camera sees through any of these lenses
  }
}

/// By hand: no perspective, k1 = -1/12 and unit scales fold at r = 2 in the image, 2 - 8/12 = 4/3 on the track.
TEST(TrackCamera, RefusesWhatLiesBehindTheFold) {
  TrackCamera::Parameters p;
  p << 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0 / 12.0, 0.0;
  const TrackCamera camera(p, {0.0, 0.0}, 1.0, 1.0);
  EXPECT_NEAR(camera.folding_radius(), 2.0, 1e-15);
  EXPECT_NEAR((*camera.to_track({1.5, 0.0}))(0), 1.5 - 1.5 * 1.5 * 1.5 / 12.0, 1e-15);
  EXPECT_NEAR((*camera.to_image({1.5 - 1.5 * 1.5 * 1.5 / 12.0, 0.0}))(0), 1.5, 1e-14);
  EXPECT_TRUE(camera.to_image({1.333, 0.0}));
  EXPECT_FALSE(camera.to_image({1.334, 0.0}));
  EXPECT_TRUE(camera.to_track({1.999, 0.0}));
  EXPECT_FALSE(camera.to_track({2.001, 0.0}));
  EXPECT_FALSE(camera.to_track({kNaN, 0.0}));
  EXPECT_FALSE(camera.to_image({0.0, kNaN}));
}

TEST(TrackCamera, RefusesWhatIsBehindTheCamera) {
  TrackCamera::Parameters p;
  p << 100.0, 0.0, 0.0, 0.0, 100.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0;
  const TrackCamera camera(p, {0.0, 0.0}, 1.0, 100.0);
  EXPECT_TRUE(camera.to_image({-1.9, 0.0}));
  EXPECT_FALSE(camera.to_image({-2.1, 0.0}));
  // x = 100 u / (1 + u/2) tends to 200 px: beyond the horizon no track is seen.
  EXPECT_TRUE(camera.to_track({199.0, 0.0}));
  EXPECT_FALSE(camera.to_track({201.0, 0.0}));
}

TEST(TrackCamera, JacobiansAreThoseOfDifferences) {
  const TrackCamera camera = testing::wide_camera();
  const Eigen::Vector2d at(0.7, 1.9);
  const Eigen::Matrix2d J = camera.J_image_track(at);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = 1e-5 * Eigen::Vector2d::Unit(i);
    const Eigen::Vector2d slope = (*camera.to_image(at + step) - *camera.to_image(at - step)) / 2e-5;
    EXPECT_LT((slope - J.col(i)).norm(), 1e-5);
  }
  const auto J_parameters = camera.J_image_parameters(at);
  for (int i = 0; i < TrackCamera::kParameters; ++i) {
    const double size = 1e-6 * std::max(1.0, std::abs(camera.parameters()(i)));
    TrackCamera::Parameters up = camera.parameters(), down = up;
    up(i) += size;
    down(i) -= size;
    const TrackCamera a(up, camera.track_centre(), camera.track_scale(), camera.image_scale());
    const TrackCamera b(down, camera.track_centre(), camera.track_scale(), camera.image_scale());
    const Eigen::Vector2d slope = (*a.to_image(at) - *b.to_image(at)) / (2.0 * size);
    EXPECT_LT((slope - J_parameters.col(i)).norm(), 1e-5 * std::max(1.0, slope.norm())) << i;
  }
}

TEST(TrackCamera, RefusesMapsThatAreNone) {
  TrackCamera::Parameters p = testing::wide_camera().parameters();
  EXPECT_NE(why([&] { (void)TrackCamera(p, {0.0, 0.0}, 0.0, 1.0); }).find("must be > 0"), std::string::npos);
  p.segment<3>(3) = 2.0 * p.segment<3>(0);
  EXPECT_NE(why([&] { (void)TrackCamera(p, {0.0, 0.0}, 1.0, 1000.0); }).find("cannot be inverted"), std::string::npos);
  p(0) = kNaN;
  EXPECT_NE(why([&] { (void)TrackCamera(p, {0.0, 0.0}, 1.0, 1000.0); }).find("not a finite"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::camera
