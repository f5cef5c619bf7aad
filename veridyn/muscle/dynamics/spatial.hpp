#pragma once

#include <Eigen/Core>

/// Six-dimensional (spatial) vectors of rigid-body motion (Featherstone, Rigid Body Dynamics Algorithms, 2008), always
/// in ground axes and taken at the origin of the ground frame. No transformation ever stands between two links:
/// velocities, forces and inertias of different links add as they are.
///
/// The price is precision far from the origin: moments of inertia of a link r metres away carry m r^2, so about
/// 1e-16 m r^2 / I of relative accuracy is lost (1e-12 for a forearm 10 m away).
namespace veridyn::muscle {

/// A vector in space.
template <typename Scalar>
using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
/// A rotation or an inertia in space.
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

/// Rate of change of a momentum `P` that is carried along with velocity `V`: V x* P.
template <typename Scalar>
[[nodiscard]] SpatialVector<Scalar> cross_force(const SpatialVector<Scalar>& V, const SpatialVector<Scalar>& P) {
  return {V.angular.cross(P.angular) + V.linear.cross(P.linear), V.angular.cross(P.linear)};
}

/// A symmetric 3 x 3 matrix by its six numbers.
template <typename Scalar>
struct Symmetric3 {
  Scalar xx{}, xy{}, xz{}, yy{}, yz{}, zz{};

  [[nodiscard]] Vector3<Scalar> operator*(const Vector3<Scalar>& v) const {
    return {xx * v.x() + xy * v.y() + xz * v.z(), xy * v.x() + yy * v.y() + yz * v.z(),
            xz * v.x() + yz * v.y() + zz * v.z()};
  }
  [[nodiscard]] Scalar trace() const { return xx + yy + zz; }
  Symmetric3& operator+=(const Symmetric3& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    return *this;
  }
  [[nodiscard]] Matrix3<Scalar> matrix() const {
    Matrix3<Scalar> m;
    m << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return m;
  }
};

/// Mass, first and second moment of mass about the ground's origin, ground axes. Inertias of bodies add as they are.
template <typename Scalar>
struct RigidInertia {
  double mass = 0.0;
  Vector3<Scalar> moment = Vector3<Scalar>::Zero();  ///< mass x mass centre
  Symmetric3<Scalar> inertia;

  /// Of a body with `inertia` about its mass centre at `center`.
  [[nodiscard]] static RigidInertia of(double mass, const Vector3<Scalar>& center, const Symmetric3<Scalar>& inertia) {
    RigidInertia I;
    I.mass = mass;
    I.moment = mass * center;
    const Scalar x2 = I.moment.x() * center.x(), y2 = I.moment.y() * center.y(), z2 = I.moment.z() * center.z();
    I.inertia.xx = inertia.xx + y2 + z2;
    I.inertia.yy = inertia.yy + x2 + z2;
    I.inertia.zz = inertia.zz + x2 + y2;
    I.inertia.xy = inertia.xy - I.moment.x() * center.y();
    I.inertia.xz = inertia.xz - I.moment.x() * center.z();
    I.inertia.yz = inertia.yz - I.moment.y() * center.z();
    return I;
  }
  /// Momentum of the motion V, or force of the acceleration V.
  [[nodiscard]] SpatialVector<Scalar> operator*(const SpatialVector<Scalar>& V) const {
    return {inertia * V.angular + moment.cross(V.linear), mass * V.linear - moment.cross(V.angular)};
  }
  RigidInertia& operator+=(const RigidInertia& o) {
    mass += o.mass;
    moment += o.moment;
    inertia += o.inertia;
    return *this;
  }
};

}  // namespace veridyn::muscle
