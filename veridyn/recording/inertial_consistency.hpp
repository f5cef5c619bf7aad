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
  /// How late the ground velocity is against accelerometer and attitude [s]: north and east, and down, which a filter
  /// of its own may have smoothed.
  double velocity_delay = 0.0, velocity_delay_sigma = 0.0;
  double vertical_delay = 0.0, vertical_delay_sigma = 0.0;
};

/// Compares the channels `accel_x|y|z`, `gyro_x|y|z`, `roll`, `pitch`, `yaw`, `vel_north|east|down` of a recording in
/// the frame frd inside `spans`; what lacks a channel, or has fewer than 60 windows, is missing.
///
/// Gains are found together with the delays and with zero and deviation of the heading, where turns show them, and the
/// velocity is shifted by its own delay, so that a late sensor is not read as a wrong scale, nor a wrong north or a
/// compass that swings as axes that are turned. First it is asked whether an axis moved enough to say anything: its
/// inverse gain n must be known to 10 % (the inverse of a number that may be anything is no gain). What is left
/// unexplained beyond the reference's white noise may be an error of the reading, which attenuates the inverse gain by
/// up to
///     a = 3 N s^2 [(X'X)^-1]_jj / n^2
/// (errors in variables, Fuller 1987, section 1.1): a doubt of the gain of the accelerometer, of 0.6 at most.
[[nodiscard]] InertialConsistency inertial_consistency(const Recording& recording, std::span<const TimeSpan> spans);

/// The rows of it: gain, bias and delays of accelerometer, velocity and gyro, and, where a wrong velocity explains a
/// contradiction better than a wrong accelerometer, of the velocity instead.
[[nodiscard]] std::vector<estimation::Evidence> inertial_evidence(const InertialConsistency& consistency);

}  // namespace veridyn::recording
