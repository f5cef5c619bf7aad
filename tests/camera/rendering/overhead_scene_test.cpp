#include "veridyn/camera/rendering/overhead_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"

namespace veridyn::camera {
namespace {

/// Straight down on 0.64 by 0.48 m at 100 px/m: one marker, nothing painted, no noise.
OverheadScene plain_scene() {
  TrackCamera::Parameters p = TrackCamera::Parameters::Zero();
  p.head<6>() << 100.0, 0.0, 32.0, 0.0, -100.0, 24.0;
  p.segment<2>(8) << 32.0, 24.0;
  OverheadScene scene{.camera = {p, {0.0, 0.0}, 1.0, 100.0}, .width = 64, .height = 48, .pose = {}};
  scene.pose = [](double) { return Eigen::Vector3d(0.05, 0.04, 0.5); };
  scene.markers = {{.place = {0.08, 0.0}, .radius = 0.02}};
  scene.line = scene.car = scene.noise = scene.photons = 0.0;
  return scene;
}

/// Light above the background: how much, its middle and its variance along x and y [px].
struct Moments {
  double light = 0.0;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero(), variance = Eigen::Vector2d::Zero();
};
Moments moments_of(const GreyImage& image, double background) {
  Moments m;
  for (const int pass : {0, 1}) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    m.light = 0.0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const double light = image.pixels[y * image.width + x] - background;
        const Eigen::Vector2d p(x, y);
        sum += light * (pass == 0 ? p : Eigen::Vector2d((p - m.middle).cwiseAbs2()));
        m.light += light;
      }
    }
    (pass == 0 ? m.middle : m.variance) = sum / m.light;
  }
  return m;
}

TEST(OverheadScene, ShowsAMarkerWhereTheCameraMapsIt) {
  const OverheadScene scene = plain_scene();
  OverheadRenderer renderer(scene, 1);
  const Moments m = moments_of(renderer.render(0.0), scene.background);
  const Eigen::Vector2d seen = *scene.camera.to_image({0.05 + 0.08 * std::cos(0.5), 0.04 + 0.08 * std::sin(0.5)});
  EXPECT_LT((m.middle - seen).norm(), 0.03);
  // A disc of 2 px; of its rim the lens takes from within what it gives without, and a little more.
  EXPECT_NEAR(m.light / (scene.markers[0].brightness * M_PI * (4.0 + 0.64)), 1.0, 0.03);
}

// 10 m/s over an exposure of 20 ms: a streak of 20 px about the middle of the exposure.
TEST(OverheadScene, BlursWhatMovesWhileItIsExposed) {
  OverheadScene scene = plain_scene();
  scene.pose = [](double t) { return Eigen::Vector3d(10.0 * t - 0.08, 0.0, 0.0); };
  const Eigen::Vector2d still = moments_of(OverheadRenderer(scene, 1).render(0.0), scene.background).variance;
  scene.exposure_s = 0.02;
  const Moments m = moments_of(OverheadRenderer(scene, 1).render(0.0), scene.background);
  EXPECT_NEAR(m.middle.x(), 32.0, 0.05);
  // Less what 4 ms blur already.
  EXPECT_NEAR(m.variance.x() - still.x(), (20.0 * 20.0 - 4.0 * 4.0) / 12.0, 1.0);
  EXPECT_NEAR(m.variance.y(), still.y(), 0.1);
}

TEST(OverheadScene, HidesTheCarAndHasTheNoiseThatIsSaid) {
  OverheadScene scene = plain_scene();
  scene.hidden = {{1.0, 2.0}};
  scene.noise = 3.0;
  const GreyImage image = OverheadRenderer(scene, 5).render(1.5);
  double sum = 0.0, squares = 0.0;
  for (const std::uint8_t p : image.pixels) {
    sum += p - 20.0;
    squares += (p - 20.0) * (p - 20.0);
  }
  const auto count = static_cast<double>(image.pixels.size());
  EXPECT_NEAR(sum / count, 0.0, 0.25);
  // Rounding to whole grey levels adds 1/12. The deviation of 3072 pixels is known to 1.3 %.
  EXPECT_NEAR(std::sqrt(squares / count), std::sqrt(9.0 + 1.0 / 12.0), 0.16);
  EXPECT_EQ(OverheadRenderer(scene, 5).render(1.5).pixels, image.pixels);
  EXPECT_NE(OverheadRenderer(scene, 6).render(1.5).pixels, image.pixels);
}

TEST(OverheadScene, RefusesWhatCannotBeSeen) {
  OverheadScene small = plain_scene(), nowhere = plain_scene(), sharp = plain_scene();
  small.width = 8;
  nowhere.pose = nullptr;
  sharp.spread_px = 0.0;
  EXPECT_EQ(why([&] { OverheadRenderer(small, 1); }), "scene: width and height must be 16 to 8192 px");
  EXPECT_EQ(why([&] { OverheadRenderer(nowhere, 1); }), "scene: the car has no pose");
  EXPECT_EQ(why([&] { OverheadRenderer(sharp, 1); }), "scene: exposure and noise must be >= 0, the spread > 0");
}

}  // namespace
}  // namespace veridyn::camera
