#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "veridyn/camera/calibration/track_camera.hpp"
#include "veridyn/camera/tracking/grey_image.hpp"
#include "veridyn/core/recording.hpp"

namespace veridyn::camera {

/// A light that stands on the track: a false marker, a reflection, a lamp.
struct SceneLight {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< [m]
  double radius = 0.006;                            ///< [m]
  double brightness = 150.0;                        ///< [grey levels]
  /// Share of its brightness at a time [s], 0 to 1; nothing: always 1.
  std::function<double(double)> flicker{};
};

/// A marker of the car.
struct SceneMarker {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< x forward, y left of the car's reference point [m]
  double radius = 0.006;                            ///< [m]
  double brightness = 170.0;                        ///< [grey levels]
  std::vector<TimeSpan> hidden{};                   ///< when it is not seen
};

/// What a camera above a track sees, for tests, examples and the virtual rig.
struct OverheadScene {
  TrackCamera camera;
  int width = 1920, height = 1080;
  /// Pose of the car (x, y [m], heading [rad]) at a time [s].
  std::function<Eigen::Vector3d(double)> pose;
  std::vector<SceneMarker> markers{};
  std::vector<SceneLight> lights{};
  std::vector<TimeSpan> hidden{};  ///< when the whole car is not seen, under a bridge
  /// Share of the light of the room at a time [s]; nothing: always 1.
  std::function<double(double)> room_light{};
  double background = 20.0;   ///< of the asphalt [grey levels]
  double line = 12.0;         ///< by which painted lines every 0.5 m are brighter [grey levels]
  double car = 6.0;           ///< by which the car's body, 0.3 by 0.15 m, is brighter [grey levels]
  double noise = 2.0;         ///< standard deviation of a pixel in the dark [grey levels]
  double photons = 0.02;      ///< variance that each grey level adds: shot noise [grey levels]
  double spread_px = 0.8;     ///< of a point of light by the lens: standard deviation of a Gaussian
  double exposure_s = 0.004;  ///< a frame at `time` is exposed half of it before and after
};

/// Frames of a scene. The picture without the car is made once; marks of light are sampled in time over the exposure.
class OverheadRenderer {
 public:
  /// @throws InputError("scene", ...) for sizes or times that make no sense
  OverheadRenderer(OverheadScene scene, std::uint64_t seed);

  [[nodiscard]] GreyImage render(double time);
  [[nodiscard]] const OverheadScene& scene() const noexcept { return scene_; }

 private:
  void add_spot(const std::vector<Eigen::Vector2d>& path, double radius_px, double brightness);

  OverheadScene scene_;
  std::vector<float> still_;  ///< asphalt and lines
  std::vector<float> light_;  ///< the frame being made
  std::vector<float> noise_;  ///< standard normal numbers, read from another place for each row
  std::uint64_t state_;
};

}  // namespace veridyn::camera
