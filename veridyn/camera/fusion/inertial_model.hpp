#pragma once

#include <Eigen/Core>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/kalman/additive_model.hpp"
#include "veridyn/estimation/kalman/kalman_model.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::camera {

/// What a gyro and an accelerometer on a car do beyond the truth, as densities of white noise and random walks.
struct InertialNoise {
  double gyro = 0.0015;  ///< [rad/s/sqrt(Hz)]
  /// Errors of the gyro that grow with the rate, scale and mounting askew (0.006: 0.6 %, 0.35 deg), as noise of this
  /// share of the rate that lasts about a second: density^2 = gyro^2 + (share |rate|)^2 1 s.
  double gyro_share = 0.006;
  double gyro_walk = 2e-4;           ///< of its bias [rad/s^2/sqrt(Hz)]
  double gyro_bias = 0.02;           ///< of its bias at the start, standard deviation [rad/s]
  double accelerometer = 0.02;       ///< [m/s^2/sqrt(Hz)]
  double accelerometer_walk = 2e-3;  ///< of its bias [m/s^3/sqrt(Hz)]
  double accelerometer_bias = 0.1;   ///< of its bias at the start, standard deviation [m/s^2]
};

/// A car that is moved by what its gyro and accelerometer measured, for the shared Kalman filter.
///
/// Frames: track x, y horizontal, z up; body x forward, y left, z up (ISO 8855). The attitude is heading, pitch, roll
/// about z, y, x; a positive pitch is nose down. The accelerometer measures a - g in the body frame, so that
///     p' = v,   v' = horizontal part of R (f - b_a) + g,   g = (0, 0, -9.80665) m/s^2,
/// and the attitude follows the gyro less its bias. Biases and the time offset of the camera are random walks; a
/// positive offset: a frame stamped t shows what was at t - offset.
struct InertialModel : estimation::AdditiveModel<14> {
  /// x, y [m]; velocity along track x, y [m/s]; heading, pitch, roll [rad]; gyro bias [rad/s]; accelerometer bias
  /// [m/s^2]; time offset [s].
  enum Index {
    kX = 0,
    kVelocity = 2,
    kHeading = 4,
    kPitch = 5,
    kRoll = 6,
    kGyroBias = 7,
    kAccelBias = 10,
    kOffset = 13
  };
  static constexpr int kDynamic = 7;
  /// What the sensors measured: rates [rad/s] and specific force [m/s^2] in the body frame.
  struct Input {
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
  };

  InertialNoise noise{};
  double offset_walk = 1e-4;  ///< of the time offset [s/sqrt(s)]

  /// Acceleration of the car in the track's axes [m/s^2], gravity taken out.
  template <typename Scalar>
  [[nodiscard]] static numerics::Vector3<Scalar> acceleration(const State<Scalar>& x, const Eigen::Vector3d& force) {
    const numerics::Matrix3<Scalar> R_body = numerics::R_body_from_ned<Scalar>(x(kRoll), x(kPitch), x(kHeading));
    const numerics::Vector3<Scalar> f = force.cast<Scalar>() - x.template segment<3>(kAccelBias);
    numerics::Vector3<Scalar> a = R_body.transpose() * f;
    a(2) -= Scalar(kGravity);
    return a;
  }
  template <typename Scalar>
  [[nodiscard]] State<Scalar> propagate(const State<Scalar>& x, const Input& u, double dt) const {
    using Vector = numerics::Vector3<Scalar>;
    const Vector omega = u.rate.cast<Scalar>() - x.template segment<3>(kGyroBias);
    // The middle of the step: half of it by Euler's rule, then the whole with the rates there.
    State<Scalar> middle = x;
    const Vector first = numerics::euler_rates<Scalar>(x(kRoll), x(kPitch), omega);
    middle(kRoll) += first(0) * (0.5 * dt);
    middle(kPitch) += first(1) * (0.5 * dt);
    middle(kHeading) += first(2) * (0.5 * dt);
    const Vector rates = numerics::euler_rates<Scalar>(middle(kRoll), middle(kPitch), omega);
    const Vector a = acceleration<Scalar>(middle, u.force);
    State<Scalar> after = x;
    for (int i = 0; i < 2; ++i) {
      after(kX + i) += x(kVelocity + i) * dt + a(i) * (0.5 * dt * dt);
      after(kVelocity + i) += a(i) * dt;
    }
    after(kRoll) += rates(0) * dt;
    after(kPitch) += rates(1) * dt;
    after(kHeading) += rates(2) * dt;
    return after;
  }
  void add_process_noise(const State<double>& /*unused*/, const Input& u, double dt,
                         Eigen::Matrix<double, kStates, kStates>& P) const {
    const double share2 = noise.gyro_share * noise.gyro_share;
    const double gyro = (noise.gyro * noise.gyro + share2 * u.rate.squaredNorm()) * dt;
    const double accel = noise.accelerometer * noise.accelerometer;
    for (int i = 0; i < 2; ++i) {
      P(kX + i, kX + i) += accel * dt * dt * dt / 3.0;
      P(kX + i, kVelocity + i) += accel * dt * dt / 2.0;
      P(kVelocity + i, kX + i) += accel * dt * dt / 2.0;
      P(kVelocity + i, kVelocity + i) += accel * dt;
    }
    for (const int i : {kHeading, kPitch, kRoll}) P(i, i) += gyro;
    for (int i = 0; i < 3; ++i) {
      P(kGyroBias + i, kGyroBias + i) += noise.gyro_walk * noise.gyro_walk * dt;
      P(kAccelBias + i, kAccelBias + i) += noise.accelerometer_walk * noise.accelerometer_walk * dt;
    }
    P(kOffset, kOffset) += offset_walk * offset_walk * dt;
  }
};

}  // namespace veridyn::camera
