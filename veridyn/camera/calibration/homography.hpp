#pragma once

#include <Eigen/Core>
#include <span>

#include "veridyn/camera/calibration/calibration_points.hpp"

namespace veridyn::camera {

/// The homography from track to image that fits the points best in the algebraic sense: the normalised direct linear
/// transformation (Hartley & Zisserman 2004, algorithm 4.2). Both sides are moved to their mean and scaled to a mean
/// distance of sqrt(2) first; without that the equations are badly conditioned.
/// @returns H, image ~ H (x, y, 1), of unit Frobenius norm
/// @throws InputError as `check_points`
[[nodiscard]] Eigen::Matrix3d direct_linear_homography(const CalibrationPoints& points);

/// Mean and scale that bring points to zero mean and a mean distance of sqrt(2).
struct PointScaling {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double scale = 1.0;  ///< divide by it
  [[nodiscard]] static PointScaling of(std::span<const Eigen::Vector2d> points);
};

}  // namespace veridyn::camera
