#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "veridyn/camera/calibration/fit_camera.hpp"
#include "veridyn/camera/tracking/blobs.hpp"

namespace veridyn::camera {

/// Where the bright markers of a car are: x forward, y left of its reference point [m], two or three. They must be at
/// the height above the track for which the camera was calibrated.
struct MarkerLayout {
  std::vector<Eigen::Vector2d> markers{{0.10, 0.0}, {-0.08, 0.05}, {-0.06, -0.04}};
  double sigma = 2e-4;  ///< error of a coordinate of a marker on the car [m]

  /// @throws InputError("markers", ...) with fewer than two or more than three markers, or where the distances between
  /// three of them differ by less than 5 mm: they would be taken for each other.
  void validate() const;
};

/// Where a car is on the track: x, y [m] of its reference point and the heading, counter-clockwise from x [rad].
struct PoseMeasurement {
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();  ///< covariance from the pixels and the layout: new in each frame
  /// Covariance from the calibration (its parameters and its systematic error): the same error in frames to come.
  Eigen::Matrix3d map = Eigen::Matrix3d::Zero();
  double chi_square = 0.0;  ///< of the markers' distances, with 2 x markers - 3 degrees of freedom
  std::size_t markers = 0;  ///< seen

  [[nodiscard]] Eigen::Matrix3d covariance() const { return noise + map; }
};

/// A spot on the track that may be a marker.
struct Spot {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();      ///< [m]
  Eigen::Matrix2d noise = Eigen::Matrix2d::Identity();  ///< covariance from the pixels [m^2]
  TrackCamera::ParameterJacobian J_place_parameters;    ///< d place / d parameters of the map
};

/// Blobs on the track, those that are disturbed or that no point of the track shows left out.
void spots_of(std::span<const Blob> blobs, const Calibration& calibration, std::vector<Spot>& spots);

/// The pose that fits spots to markers best in the sense of their covariances, by Gauss and Newton's method from the
/// closed form for equal weights (Arun, Huang & Blostein 1987, IEEE PAMI 9:698). `spots[i]` shows marker `which[i]`.
/// The covariance is that of the weighted fit; errors of the map enter through the same fit.
/// @returns nothing where fewer than two spots are given or they lie at one place
[[nodiscard]] std::optional<PoseMeasurement> fit_pose(std::span<const Spot* const> spots,
                                                      std::span<const std::size_t> which, const MarkerLayout& layout,
                                                      const Calibration& calibration);

}  // namespace veridyn::camera
