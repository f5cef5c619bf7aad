#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::recording {

/// Whether recorded accelerations hold gravity, as those of an accelerometer do.
enum class GravityIn {
  kDecide,  ///< by accel_z: about 1 g in the mean, or about none
  kYes,
  kNo,  ///< accelerations against the world, as games give them
};

/// What is known of a recording of a motion beyond its channels.
struct MotionOptions {
  GravityIn gravity = GravityIn::kDecide;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of the accelerometer from the centre of gravity, body axes [m]
};

/// The samples of a recorded motion, and what was assumed.
struct RecordedMotion {
  std::vector<MotionSample> samples;  ///< in the recording's frame, on the stamps of its accelerometer
  std::vector<std::string> notes;
};

/// Samples from the channels `accel_x|y|z`, `gyro_x|y|z` (or `roll_rate`, `yaw_rate`), `roll`, `pitch`, `yaw`, `pos_x`,
/// `pos_y`, `speed`, `steer`, each on its own stamps; the accelerometer's stamps are kept as they are, the others'
/// values are taken on lines between theirs. Angular accelerations are derived from the rates by central differences.
/// Samples in which an acceleration is missing are left out. accel_x and accel_y are needed; without accel_z gravity is
/// put there.
/// @param recording in frame flu or frd
/// @throws InputError naming file and channel: what is missing, accelerations that are in g or hold gravity twice,
/// rates in deg/s taken for rad/s, an accelerometer slower than 5 Hz.
[[nodiscard]] RecordedMotion motion_samples(const Recording& recording, const MotionOptions& options = {});

/// Channels `accel_x|y|z`, `gyro_x|y|z`, `roll`, `pitch`, `yaw`, `pos_x`, `pos_y` of samples that know them, on the
/// samples' stamps.
[[nodiscard]] Recording to_recording(const std::vector<MotionSample>& samples);

}  // namespace veridyn::recording
