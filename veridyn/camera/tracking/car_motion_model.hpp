#pragma once

#include <Eigen/Core>
#include <cmath>

#include "veridyn/estimation/kalman/additive_model.hpp"
#include "veridyn/estimation/kalman/kalman_model.hpp"

namespace veridyn::camera {

/// A car on a plane whose velocity in its own frame and yaw rate walk at random: with none of that it drives on a
/// circle.
///
/// Error: x, y [m], heading [rad] on the track; velocity forward and left [m/s], yaw rate [rad/s]. For the shared
/// Kalman filter.
struct CarMotionModel : estimation::AdditiveModel<6> {
  static constexpr int kDynamic = 3;
  struct Input {};

  double forward = 1.0;  ///< spectral density of the acceleration along the car [m^2/s^3]: 1 m/s^2 that lasts about 1 s
  double left = 0.05;    ///< of the slip velocity's change [m^2/s^3]
  double yaw = 3.0;      ///< of the yaw acceleration [rad^2/s^3]

  template <typename Scalar>
  [[nodiscard]] State<Scalar> propagate(const State<Scalar>& x, const Input& /*unused*/, double dt) const {
    using std::cos;
    using std::sin;
    // On an arc of constant yaw rate the chord has the heading of its middle; its length is that of the arc to third
    // order in the turn.
    const Scalar middle = x(2) + x(5) * (0.5 * dt);
    const Scalar c = cos(middle), s = sin(middle);
    State<Scalar> after = x;
    after(0) += (c * x(3) - s * x(4)) * dt;
    after(1) += (s * x(3) + c * x(4)) * dt;
    after(2) += x(5) * dt;
    return after;
  }
  /// White noise on the three velocities, integrated over the step.
  void add_process_noise(const State<double>& x, const Input& /*unused*/, double dt,
                         Eigen::Matrix<double, 6, 6>& P) const {
    Eigen::Matrix3d G = Eigen::Matrix3d::Identity();  // d pose rate / d velocities
    const double c = std::cos(x(2)), s = std::sin(x(2));
    G.topLeftCorner<2, 2>() << c, -s, s, c;
    const Eigen::Matrix3d Q = Eigen::Vector3d(forward, left, yaw).asDiagonal();
    const Eigen::Matrix3d GQ = G * Q;
    P.topLeftCorner<3, 3>() += (dt * dt * dt / 3.0) * (GQ * G.transpose());
    P.topRightCorner<3, 3>() += (dt * dt / 2.0) * GQ;
    P.bottomLeftCorner<3, 3>() += (dt * dt / 2.0) * GQ.transpose();
    P.bottomRightCorner<3, 3>() += dt * Q;
  }
};

}  // namespace veridyn::camera
