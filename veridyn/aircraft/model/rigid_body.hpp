#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {

/// Mass [kg] and inertia about the centre of gravity [kg m^2] with its inverse.
struct MassProperties {
  double mass = 0.0;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero();

  MassProperties() = default;
  MassProperties(double m, const Eigen::Matrix3d& J) : mass(m), inertia(J), inverse_inertia(J.inverse()) {}
};

/// State of a rigid body over a flat earth, as one vector so that integrators can sum it:
/// position NED [m] (0-2), inertial velocity NED [m/s] (3-5), attitude quaternion body to NED as x, y, z, w (6-9), body
/// rates [rad/s] (10-12).
template <typename Scalar>
using RigidBodyState = Eigen::Matrix<Scalar, 13, 1>;

/// The attitude, body to NED.
template <typename Scalar>
[[nodiscard]] Eigen::Quaternion<Scalar> attitude_of(const RigidBodyState<Scalar>& x) {
  return Eigen::Quaternion<Scalar>(x(9), x(6), x(7), x(8));
}

/// The quaternion back to unit length: rounding and truncation let it drift by O(h^5) a step.
template <typename Scalar>
void normalise_attitude(RigidBodyState<Scalar>& x) {
  x.template segment<4>(6) /= x.template segment<4>(6).norm();
}

/// Body-axes matrix from NED components of the state's attitude.
template <typename Scalar>
[[nodiscard]] numerics::Matrix3<Scalar> R_body_from_ned(const RigidBodyState<Scalar>& x) {
  return attitude_of(x).toRotationMatrix().transpose();
}

/// Equations of motion under a force and a moment about the centre of gravity in body axes, gravity aside:
/// p' = v, v' = R_NB F/m + [0 0 g], q' = q (0, omega)/2, omega' = J^-1 (M - omega x J omega).
template <typename Scalar>
[[nodiscard]] RigidBodyState<Scalar> rigid_body_rate(const RigidBodyState<Scalar>& x, const MassProperties& body,
                                                     const numerics::Vector3<Scalar>& force_B,
                                                     const numerics::Vector3<Scalar>& moment_B, double gravity) {
  const Eigen::Quaternion<Scalar> q = attitude_of(x);
  const numerics::Vector3<Scalar> omega = x.template tail<3>();
  RigidBodyState<Scalar> rate;
  rate.template head<3>() = x.template segment<3>(3);
  rate.template segment<3>(3) = q.toRotationMatrix() * force_B / Scalar(body.mass);
  rate(5) += Scalar(gravity);
  rate.template segment<4>(6) = numerics::quaternion_rate(q, omega);
  const numerics::Vector3<Scalar> momentum = body.inertia.template cast<Scalar>() * omega;
  rate.template tail<3>() = body.inverse_inertia.template cast<Scalar>() * (moment_B - omega.cross(momentum));
  return rate;
}

}  // namespace veridyn::aircraft
