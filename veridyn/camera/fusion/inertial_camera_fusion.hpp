#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <deque>
#include <optional>

#include "veridyn/camera/fusion/inertial_model.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/kalman/kalman_filter.hpp"

namespace veridyn::camera {

/// How inertial sensors and camera are fused.
struct FusionOptions {
  InertialNoise noise{};
  /// Of the inertial sensors from the point of the car whose pose the camera gives: x forward, y left [m].
  Eigen::Vector2d sensor_place = Eigen::Vector2d::Zero();
  double offset = 0.0;                       ///< of the camera's stamps at the start [s]; positive: they are late
  double offset_sigma = 0.06;                ///< of that, standard deviation [s]
  double offset_walk = 1e-4;                 ///< [s/sqrt(s)]: what a clock of 10 ppm drifts in a few minutes
  double inclination_sigma = 5.0 * kDegree;  ///< of pitch and roll at the start [rad]
  double lag_s = 0.5;                        ///< frames that arrive up to this late are entered where they belong
  double longest_gap_s = 0.1;  ///< between inertial samples: after a longer one the fusion starts again with a frame

  /// @throws InputError("fusion", ...) naming the option
  void validate() const;
  [[nodiscard]] static const KeyTable<FusionOptions>& keys();
};

/// The motion of the car at the time of an inertial sample, with standard deviations. A 95 % band is 1.96 of them.
struct FusedMotion {
  double time = 0.0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of the sensors on the track [m]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< along track x, y [m/s]
  double heading = 0.0;                                ///< [rad], counter-clockwise from x, -pi to pi
  double pitch = 0.0;                                  ///< inclination forward [rad], nose down positive
  double roll = 0.0;                                   ///< inclination to the side [rad], right side down positive
  /// Without gravity, along the car (forward) and across (left), horizontal [m/s^2].
  Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  ///< [m/s^2]
  double offset = 0.0;                                   ///< of the camera's stamps [s]
  Eigen::Matrix<double, InertialModel::kStates, 1> sigma =
      Eigen::Matrix<double, InertialModel::kStates, 1>::Zero();  ///< of the states as InertialModel orders them
  Eigen::Vector2d sigma_acceleration =
      Eigen::Vector2d::Zero();  ///< of the states; noise of the sample itself comes on top
};

/// Where the car is, how it is inclined and how it accelerates, from inertial sensors and a camera.
///
/// An accelerometer alone cannot tell an inclination from an acceleration; a camera that sees the place knows the
/// acceleration below about 1 Hz, so that what remains is inclination, and the gyro carries both above. The Kalman
/// filter finds that division by itself from the noise of the sensors.
///
/// Every inertial sample leaves a copy of the filter. A frame is entered at the sample before its own time, stamp less
/// offset, and the samples and frames after that are run again: what comes late is entered as if it had come in time.
/// The time offset is a state; a measured coordinate depends on it by minus its rate, and terms of second order (offset
/// times velocity, offset squared times acceleration) widen the measurement while the offset is uncertain (Athans,
/// Wishner & Bertolini 1968, IEEE Trans Autom Control 13:504). Without clocks and threads; equal input, equal result.
class InertialCameraFusion {
 public:
  /// @throws InputError as the options
  explicit InertialCameraFusion(const FusionOptions& options);

  /// A sample of gyro [rad/s] and accelerometer [m/s^2] in the body frame; samples come in order.
  /// @throws InputError("inertial sample", ...) when something is not finite or its time not after the last
  void add_inertial(double time, const Eigen::Vector3d& rate, const Eigen::Vector3d& force);
  /// A pose from the camera (x, y [m], heading [rad]) with its covariance, in any order within the lag.
  /// @throws InputError("camera pose", ...) when something is not finite or the covariance not positive definite
  /// @returns whether it was entered, or will be with the samples that reach its time; false: too late, or before the
  /// first sample
  bool add_camera(double stamp, const Eigen::Vector3d& pose, const Eigen::Matrix3d& covariance);

  /// The motion at the last inertial sample; nothing before the first frame or since a gap.
  [[nodiscard]] std::optional<FusedMotion> now() const;
  /// Innovations of x, y and heading of the camera, whitened; each frame once.
  [[nodiscard]] const std::array<estimation::InnovationMonitor, 3>& innovations() const noexcept { return monitors_; }
  [[nodiscard]] std::size_t too_late() const noexcept { return too_late_; }
  [[nodiscard]] std::size_t gaps() const noexcept { return gaps_; }

 private:
  using Filter = estimation::ExtendedKalmanFilter<InertialModel>;
  struct Frame {
    double stamp;
    Eigen::Vector3d pose;
    Eigen::Matrix3d covariance;
  };
  /// The filter after an inertial sample and all frames up to it.
  struct Step {
    double time;
    InertialModel::Input sample;
    Filter filter;
    std::array<estimation::InnovationMonitor, 3> monitors;
    std::size_t next_frame;  ///< number, counted from the first of all, of the first frame not yet entered
  };

  void start(const Frame& frame);
  /// Makes `to` from the step before it.
  void run(const Step& from, Step& to);
  void enter(const Frame& frame, double time, const InertialModel::Input& input, const Eigen::Vector3d& angular,
             Filter& filter, std::array<estimation::InnovationMonitor, 3>& monitors) const;
  void forget();

  FusionOptions options_;
  InertialModel model_;
  std::deque<Step> steps_;
  std::deque<Frame> frames_;     ///< by stamp
  std::size_t first_frame_ = 0;  ///< number of the first in `frames_`
  std::array<estimation::InnovationMonitor, 3> monitors_{};
  bool running_ = false;
  std::size_t too_late_ = 0, gaps_ = 0;
};

}  // namespace veridyn::camera
