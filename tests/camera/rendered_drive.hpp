#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "tests/camera/synthetic_camera.hpp"
#include "veridyn/camera/rendering/overhead_scene.hpp"
#include "veridyn/camera/tracking/car_tracker.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::camera::testing {

/// A drive on a figure of eight at about 1.5 m/s with a speed that swings, and a slip angle: no model of the tracker's.
inline Eigen::Vector3d figure_of_eight(double t) {
  const double s = 0.9 * t + 0.25 * std::sin(0.8 * t);
  const Eigen::Vector2d place(2.2 + 1.6 * std::sin(s), 1.2 + 0.7 * std::sin(2.0 * s));
  const double dx = 1.6 * std::cos(s), dy = 1.4 * std::cos(2.0 * s);
  return {place(0), place(1), std::atan2(dy, dx) + 0.06 * std::sin(1.3 * t)};
}

/// The wide camera at half its size: pictures of 960 x 540 px.
inline TrackCamera half_size_camera() {
  TrackCamera::Parameters p = wide_camera().parameters();
  p.head<6>() *= 0.5;
  p.segment<2>(8) *= 0.5;
  return {p, {2.2, 1.2}, 1.45, 550.0};
}

/// A scene with everything that disturbs: the car hidden for a second, single markers hidden, blur by the motion, two
/// bright false markers, a lamp that flickers and the light of a room that does.
inline OverheadScene disturbed_scene(const TrackCamera& camera, int width, int height) {
  OverheadScene scene{.camera = camera, .width = width, .height = height, .pose = figure_of_eight};
  for (const Eigen::Vector2d& m : MarkerLayout{}.markers) scene.markers.push_back({.place = m, .radius = 0.01});
  scene.markers[1].hidden = {{4.0, 4.4}};
  scene.markers[0].hidden = {{5.0, 5.2}};
  scene.hidden = {{2.0, 3.0}};
  scene.exposure_s = 0.01;
  scene.lights = {
      {.place = {1.4, 1.3}, .radius = 0.01, .brightness = 220.0, .flicker = {}},
      {.place = {2.9, 1.75}, .radius = 0.012, .brightness = 200.0, .flicker = {}},
      {.place = {3.2, 0.6},
       .radius = 0.03,
       .brightness = 230.0,
       .flicker = [](double t) { return std::fmod(7.3 * t, 1.0) < 0.5 ? 1.0 : 0.1; }},
  };
  scene.room_light = [](double t) { return 1.0 + 0.25 * std::sin(2.0 * kPi * 8.7 * t); };
  return scene;
}

}  // namespace veridyn::camera::testing
