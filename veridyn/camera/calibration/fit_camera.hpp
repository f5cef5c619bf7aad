#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "veridyn/camera/calibration/calibration_points.hpp"
#include "veridyn/camera/calibration/track_camera.hpp"

namespace veridyn::camera {

/// What of the lens is fitted.
enum class Distortion {
  kAuto,    ///< radial where an F test says at 0.1 % that the points need it, else none
  kNone,    ///< the homography alone: 8 parameters, at least 4 points
  kRadial,  ///< with centre and two radial terms: 12 parameters, at least 6 points
};

/// What a calibration point is off the fitted map.
struct CalibrationResidual {
  Eigen::Vector2d track = Eigen::Vector2d::Zero();  ///< where its image is mapped to, minus where it is [m]
  Eigen::Vector2d image = Eigen::Vector2d::Zero();  ///< where it was seen, minus where it is mapped to [px]
};

/// A fitted map with what it is worth.
struct Calibration {
  TrackCamera camera;
  bool distorted = false;  ///< whether centre and radial terms were fitted; else the centre is the points' mean
  bool converged = false;  ///< whether the least-squares problem came to rest
  std::size_t points = 0;  ///< that were fitted
  double sigma_image =
      0.0;  ///< of one coordinate of a point [px]: sqrt(sum of squares / degrees of freedom); NaN: none
  /// Of the parameters, from the Jacobian and `sigma_image`, which takes errors of the points as independent; rows of
  /// parameters that were not fitted are zero. NaN without degrees of freedom.
  Eigen::Matrix<double, TrackCamera::kParameters, TrackCamera::kParameters> covariance =
      Eigen::Matrix<double, TrackCamera::kParameters, TrackCamera::kParameters>::Zero();
  std::vector<CalibrationResidual> residuals;  ///< of each point
  double rms_image = 0.0;                      ///< of the distance between seen and mapped [px]
  double rms_track = 0.0;                      ///< the same on the track [m]
  /// Of one coordinate in the image [px]: the part of the residuals that neighbouring points share, which is an error
  /// of the map and no noise: sqrt(correlation with neighbours) of `sigma_image`; 0 where they are independent.
  double systematic_image = 0.0;

  /// Standard errors of the parameters.
  [[nodiscard]] TrackCamera::Parameters sigma() const { return covariance.diagonal().cwiseSqrt(); }
  /// Covariance [m^2] of a place on the track that was seen in the image with an error of covariance `image` [px^2]:
  /// this error and that of the fitted parameters through the map. A point of the track that the camera sees.
  [[nodiscard]] Eigen::Matrix2d track_covariance(const Eigen::Vector2d& track, const Eigen::Matrix2d& image) const;
  /// Covariance [m^2] of `systematic_image` there, which places that are close together have in common.
  [[nodiscard]] Eigen::Matrix2d systematic_covariance(const Eigen::Vector2d& track) const;
};

/// The map that fits the points with the least sum of squares in the image, from the direct linear homography, by
/// Levenberg and Marquardt's method (Ceres).
/// @throws InputError as `check_points`; with too few points for the distortion asked for; where the fitted distortion
/// folds back within the points, which no lens does, and then names the point
[[nodiscard]] Calibration fit_camera(const CalibrationPoints& points, Distortion distortion = Distortion::kAuto);

/// The residuals of points against a map. A point that the map cannot place has NaN.
[[nodiscard]] std::vector<CalibrationResidual> residuals_of(const TrackCamera& camera, const CalibrationPoints& points);
/// Root of the mean squared length of the residuals on the track [m]; NaN where one is.
[[nodiscard]] double rms_track(const std::vector<CalibrationResidual>& residuals);

/// A map fitted on half of the points, chosen by chance, and measured on the other half.
struct HeldOut {
  std::size_t fitted = 0, held_out = 0;
  double rms_fitted = 0.0;    ///< [m] on the track
  double rms_held_out = 0.0;  ///< [m]
  double worst = 0.0;         ///< largest distance of a point that was held out [m]
  std::size_t worst_point = 0;
};

/// @throws InputError as `fit_camera`, and with fewer than 8 points
[[nodiscard]] HeldOut hold_out_half(const CalibrationPoints& points, Distortion distortion, std::uint64_t seed);

}  // namespace veridyn::camera
