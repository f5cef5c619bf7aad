#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <memory>

#include "veridyn/camera/calibration/fit_camera.hpp"
#include "veridyn/camera/rendering/overhead_scene.hpp"
#include "veridyn/camera/tracking/marker_pose.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::camera {

/// A camera of the virtual rig, from `[live.camera.view]`.
struct VirtualCameraOptions {
  std::array<double, 2> x{-10.0, 10.0}, y{-5.0, 5.0};  ///< [m]
  int width = 1920, height = 1080;                     ///< [px]
  double rate_Hz = 30.0;
  double exposure_s = 0.004;

  [[nodiscard]] static const KeyTable<VirtualCameraOptions>& keys();
};

/// Sees a car whose motion others simulate, from far above a level track, a little oblique, through a lens with a
/// barrel distortion: its markers over the exposure, a lamp that flickers and a false marker at the edge of the track.
/// Its calibration is fitted to points that were read from its picture, as that of a real one.
class VirtualCamera {
 public:
  /// @throws InputError where the picture's pixels are too few for the car's markers (`x`, `y`, `width`, `height`)
  VirtualCamera(const VirtualCameraOptions& options, const MarkerLayout& markers, std::uint64_t seed);
  // The scene knows this camera by its address.
  VirtualCamera(const VirtualCamera&) = delete;
  VirtualCamera& operator=(const VirtualCamera&) = delete;

  /// Where the car is [m, m, rad] at a time [s], not before the one before.
  void place(double time, const Eigen::Vector3d& pose);
  /// Whether it is known where the car was over the exposure of a picture at this time.
  [[nodiscard]] bool knows(double time) const;
  /// The picture exposed around a time that it knows: places in between on a line.
  [[nodiscard]] GreyImage picture(double time);

  [[nodiscard]] const Calibration& calibration() const noexcept { return calibration_; }
  [[nodiscard]] const VirtualCameraOptions& options() const noexcept { return options_; }

 private:
  struct Placed {
    double time;
    Eigen::Vector3d pose;
  };
  [[nodiscard]] Eigen::Vector3d pose_at(double time) const;

  VirtualCameraOptions options_;
  Calibration calibration_;
  std::deque<Placed> places_;
  std::unique_ptr<OverheadRenderer> renderer_;  ///< its scene asks this camera where the car is
};

}  // namespace veridyn::camera
