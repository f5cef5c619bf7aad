#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/camera/tracking/car_tracker.hpp"

namespace veridyn::camera {

/// A pose that was measured at a time.
struct TimedPose {
  double time = 0.0;                               ///< [s]
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();  ///< x, y [m], heading [rad]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// The filtered poses as CSV: time, seen (1: in this frame, 0: predicted), pose, covariance, velocity forward and left,
/// yaw rate. Frames in which the car was lost have no row.
[[nodiscard]] std::string poses_csv(std::span<const TrackedPose> poses);
/// The poses of single frames as CSV: time, pose, covariance, number of markers. What the fusion takes.
[[nodiscard]] std::string measured_poses_csv(std::span<const TrackedPose> poses);

/// Reads such a file: columns time, x, y, heading, cov_xx, cov_xy, cov_xh, cov_yy, cov_yh, cov_hh.
/// @throws InputError with file and line for what is missing, not finite, not after the row before, or no covariance
[[nodiscard]] std::vector<TimedPose> read_poses(const std::filesystem::path& path);
/// The same from text.
[[nodiscard]] std::vector<TimedPose> parse_poses(std::string_view text, std::string source);

}  // namespace veridyn::camera
