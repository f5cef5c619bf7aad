#pragma once

#include <Eigen/Core>

/// Six-dimensional (spatial) vectors of rigid-body motion (Featherstone, Rigid Body Dynamics Algorithms, 2008), always
/// in ground axes and taken at the origin of the ground frame. No transformation ever stands between two links:
/// velocities, forces and inertias of different links add as they are.
///
/// The price is precision far from the origin: moments of inertia of a link r metres away carry m r^2, so about
/// 1e-16 m r^2 / I of relative accuracy is lost (1e-12 for a forearm 10 m away).
namespace veridyn::muscle {

template <typename Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
template <typename Scalar>
using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

/// A motion: angular velocity and the velocity of the body-fixed point that passes through the ground's origin; a point
/// P of the body moves with angular x P + linear. Or a force: moment about the ground's origin (angular) and force
/// (linear).
template <typename Scalar>
struct SpatialVector {
  Vector3<Scalar> angular = Vector3<Scalar>::Zero();
  Vector3<Scalar> linear = Vector3<Scalar>::Zero();

  [[nodiscard]] Vector3<Scalar> at(const Vector3<Scalar>& point) const { return angular.cross(point) + linear; }
  [[nodiscard]] Scalar dot(const SpatialVector& other) const {
    return angular.dot(other.angular) + linear.dot(other.linear);
  }
  SpatialVector& operator+=(const SpatialVector& other) {
    angular += other.angular;
    linear += other.linear;
    return *this;
  }
  void add_scaled(const Scalar& factor, const SpatialVector& other) {
    angular += factor * other.angular;
    linear += factor * other.linear;
  }
};

/// Rate of change of a motion vector `axis` that is carried along with velocity `V`: V x axis.
template <typename Scalar>
[[nodiscard]] SpatialVector<Scalar> cross_motion(const SpatialVector<Scalar>& V, const SpatialVector<Scalar>& axis) {
  return {V.angular.cross(axis.angular), V.angular.cross(axis.linear) + V.linear.cross(axis.angular)};
}

}  // namespace veridyn::muscle
