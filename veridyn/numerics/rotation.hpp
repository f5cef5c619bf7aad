#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::numerics {

/// Three components along the axes of a frame.
template <typename Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
/// A rotation or a tensor in three dimensions.
template <typename Scalar>
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

/// Euler angles of the 3-2-1 sequence [rad]: roll phi, pitch theta, yaw psi.
template <typename Scalar>
struct EulerAngles {
  Scalar phi{0.0};
  Scalar theta{0.0};
  Scalar psi{0.0};
};

/// The matrix that takes components in the inertial frame (north, east, down) to body components (forward, right,
/// down): rotate by psi about down, by theta about the new right, by phi about the new forward axis (Beard & McLain
/// 2012, eq. 2.5). Its transpose takes body to inertial components.
template <typename Scalar>
[[nodiscard]] Matrix3<Scalar> R_body_from_ned(const Scalar& phi, const Scalar& theta, const Scalar& psi) {
  using std::cos;
  using std::sin;
  const Scalar cf = cos(phi), sf = sin(phi), ct = cos(theta), st = sin(theta), cp = cos(psi), sp = sin(psi);
  Matrix3<Scalar> R;
  R << ct * cp, ct * sp, -st,                                   //
      sf * st * cp - cf * sp, sf * st * sp + cf * cp, sf * ct,  //
      cf * st * cp + sf * sp, cf * st * sp - sf * cp, cf * ct;
  return R;
}

/// Rates of the Euler angles [phi', theta', psi'] from body rates [rad/s] (Beard & McLain 2012, eq. 3.3). Singular at
/// theta = +-90 deg.
template <typename Scalar>
[[nodiscard]] Vector3<Scalar> euler_rates(const Scalar& phi, const Scalar& theta, const Vector3<Scalar>& omega) {
  using std::cos;
  using std::sin;
  const Scalar cf = cos(phi), sf = sin(phi), ct = cos(theta), tt = sin(theta) / ct;
  const Scalar turn = sf * omega(1) + cf * omega(2);
  return Vector3<Scalar>(omega(0) + tt * turn, cf * omega(1) - sf * omega(2), turn / ct);
}

/// Body rates [p, q, r] from the rates of the Euler angles: the inverse of `euler_rates`, regular everywhere.
template <typename Scalar>
[[nodiscard]] Vector3<Scalar> body_rates(const Scalar& phi, const Scalar& theta, const Vector3<Scalar>& rates) {
  using std::cos;
  using std::sin;
  const Scalar cf = cos(phi), sf = sin(phi), ct = cos(theta), st = sin(theta);
  return Vector3<Scalar>(rates(0) - st * rates(2), cf * rates(1) + sf * ct * rates(2),
                         -sf * rates(1) + cf * ct * rates(2));
}

/// The unit quaternion of an attitude: `quaternion.toRotationMatrix()` takes body to inertial (NED) components, the
/// transpose of `R_body_from_ned`.
template <typename Scalar>
[[nodiscard]] Eigen::Quaternion<Scalar> quaternion_from_euler(const Scalar& phi, const Scalar& theta,
                                                              const Scalar& psi) {
  using std::cos;
  using std::sin;
  const Scalar half(0.5);
  const Scalar cf = cos(half * phi), sf = sin(half * phi), ct = cos(half * theta), st = sin(half * theta),
               cp = cos(half * psi), sp = sin(half * psi);
  return Eigen::Quaternion<Scalar>(cf * ct * cp + sf * st * sp, sf * ct * cp - cf * st * sp,
                                   cf * st * cp + sf * ct * sp, cf * ct * sp - sf * st * cp);
}

/// Euler angles of a quaternion (body to NED), which need not be of exact unit length: phi and psi in (-pi, pi], theta
/// in [-pi/2, pi/2]. At theta = +-90 deg only the sum or difference of phi and psi is determined.
template <typename Scalar>
[[nodiscard]] EulerAngles<Scalar> euler_from_quaternion(const Eigen::Quaternion<Scalar>& q) {
  using std::asin;
  using std::atan2;
  const Scalar n = q.squaredNorm();
  const Scalar two(2.0);
  Scalar s = two * (q.w() * q.y() - q.z() * q.x()) / n;
  if (s > Scalar(1.0)) s = Scalar(1.0);
  if (s < Scalar(-1.0)) s = Scalar(-1.0);
  EulerAngles<Scalar> e;
  e.phi = atan2(two * (q.w() * q.x() + q.y() * q.z()), n - two * (q.x() * q.x() + q.y() * q.y()));
  e.theta = asin(s);
  e.psi = atan2(two * (q.w() * q.z() + q.x() * q.y()), n - two * (q.y() * q.y() + q.z() * q.z()));
  return e;
}

/// Rate of change of the quaternion (body to NED) under body rates [rad/s]: q' = q (0, omega) / 2, as coefficients
/// (x, y, z, w) in Eigen's storage order.
template <typename Scalar>
[[nodiscard]] Eigen::Matrix<Scalar, 4, 1> quaternion_rate(const Eigen::Quaternion<Scalar>& q,
                                                          const Vector3<Scalar>& omega) {
  const Scalar half(0.5);
  Eigen::Matrix<Scalar, 4, 1> rate;
  rate << half * (q.w() * omega(0) + q.y() * omega(2) - q.z() * omega(1)),
      half * (q.w() * omega(1) + q.z() * omega(0) - q.x() * omega(2)),
      half * (q.w() * omega(2) + q.x() * omega(1) - q.y() * omega(0)),
      -half * (q.x() * omega(0) + q.y() * omega(1) + q.z() * omega(2));
  return rate;
}

/// An angle brought to (-pi, pi].
[[nodiscard]] inline double wrap_angle(double angle) {
  const double wrapped = std::remainder(angle, kFullTurn);
  return wrapped <= -kPi ? wrapped + kFullTurn : wrapped;
}

}  // namespace veridyn::numerics
