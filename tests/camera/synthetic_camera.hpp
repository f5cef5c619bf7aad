#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "veridyn/camera/calibration/calibration_points.hpp"
#include "veridyn/camera/calibration/track_camera.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::camera::testing {

/// A camera 430 px/m over a track of 4.4 by 2.4 m, a little oblique, of a lens with a barrel distortion of 4 % in the
/// corners of 1920 x 1080 px.
inline TrackCamera wide_camera(double k1 = -0.05, double k2 = 0.01) {
  TrackCamera::Parameters p;
  p << 620.0, 12.0, 955.0, 9.0, -625.0, 545.0, 0.03, -0.02, 970.0, 530.0, k1, k2;
  return {p, {2.2, 1.2}, 1.45, 1100.0};
}

/// A grid of points as that camera sees it, with noise in the image.
inline CalibrationPoints grid_points(const TrackCamera& camera, double spacing, double noise_px, std::uint64_t seed) {
  numerics::RandomStream random(seed, "points");
  CalibrationPoints points{.source = "grid", .points = {}};
  for (double x = 0.1; x < 4.35; x += spacing) {
    for (double y = 0.1; y < 2.35; y += spacing) {
      const Eigen::Vector2d image = *camera.to_image({x, y});
      points.points.push_back(
          {{x, y}, {image(0) + noise_px * random.normal(), image(1) + noise_px * random.normal()}, 0});
    }
  }
  return points;
}

}  // namespace veridyn::camera::testing
