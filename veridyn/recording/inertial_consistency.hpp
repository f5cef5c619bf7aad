#pragma once

#include <optional>
#include <span>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/recording/sensor_matrix.hpp"

namespace veridyn::recording {

/// What accelerometer, gyro, attitude and ground velocity say of each other, whatever body carries them (FRD axes).
struct InertialConsistency {
  /// Specific force against the change of velocity and gravity: over windows that begin and end at fixes,
  /// v(t1) - v(t0) = integral of R' N (f - b) + g (t1 - t0), linear in the inverse gain N and the bias.
  std::optional<SensorMatrix> accelerometer;
  /// The same with the accelerometer right and the velocity wrong: gain and sign of north, east, down.
  std::optional<SensorMatrix> velocity;
  /// Angular rates against the change of the Euler angles over windows.
  std::optional<SensorMatrix> gyro;
  /// How late the accelerometer is against gyro and attitude [s], found with how late the velocity is against both.
  std::optional<double> accelerometer_delay;
  double accelerometer_delay_sigma = 0.0;
};

/// Compares the channels `accel_x|y|z`, `gyro_x|y|z`, `roll`, `pitch`, `yaw`, `vel_north|east|down` of a recording in
/// the frame frd inside `spans`; what lacks a channel, or has fewer than 60 windows, is missing.
[[nodiscard]] InertialConsistency inertial_consistency(const Recording& recording, std::span<const TimeSpan> spans);

/// The rows of it: gain and bias of accelerometer and gyro, and, where a wrong velocity explains a contradiction better
/// than a wrong accelerometer, of the velocity instead.
[[nodiscard]] std::vector<estimation::Evidence> inertial_evidence(const InertialConsistency& consistency);

}  // namespace veridyn::recording
