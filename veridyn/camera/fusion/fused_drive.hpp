#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/camera/fusion/inertial_camera_fusion.hpp"
#include "veridyn/camera/tracking/pose_tables.hpp"

namespace veridyn::camera {

/// What gyro and accelerometer measured at a time, in the body frame (x forward, y left, z up).
struct InertialReading {
  double time = 0.0;                                ///< [s]
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< a - g [m/s^2]
};

/// Reads a table with the columns time, rate_x, rate_y, rate_z, force_x, force_y, force_z with their units.
/// @throws InputError with file and line for what is missing, of another dimension, not finite, or not in order
[[nodiscard]] std::vector<InertialReading> read_inertial(const std::filesystem::path& path);
/// The same from text.
[[nodiscard]] std::vector<InertialReading> parse_inertial(std::string_view text, std::string source);

/// A recorded drive after the fusion.
struct FusedDrive {
  std::vector<FusedMotion> motion;  ///< at each inertial sample from the first frame on
  std::size_t frames = 0;           ///< entered
  std::size_t left_out = 0;         ///< frames before the first sample, after the last or too late
  std::size_t gaps = 0;             ///< of the inertial sensors, after which the fusion began again
  std::array<estimation::InnovationSummary, 3> innovations{};  ///< of x, y and heading, whitened
};

/// Fuses a recording: each pose is entered with the first sample after its stamp, so that the result at a time knows
/// nothing of what came later.
/// @throws InputError as the options, and where the two recordings have no time in common
[[nodiscard]] FusedDrive fuse(std::span<const InertialReading> inertial, std::span<const TimedPose> poses,
                              const FusionOptions& options);

/// The motion as CSV: time, position, velocity, heading, pitch, roll, acceleration forward and left, biases, time
/// offset, and the standard deviation of each under sigma_<name>.
[[nodiscard]] std::string to_csv(std::span<const FusedMotion> motion);

}  // namespace veridyn::camera
