#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/wrap_lift.hpp"
#include "veridyn/muscle/path/wrap_result.hpp"

namespace veridyn::muscle {

/// A sphere about the origin.
struct WrapSphere {
  double radius = 0.0;  ///< [m]
  WrapQuadrant quadrant;
};

namespace internal {

/// Both ends outside.
template <typename Scalar>
void wrap_outside(const WrapSphere& sphere, const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& q,
                  WrapResult<Scalar>& result) {
  using std::atan2;
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  result.clear();
  const Eigen::Vector3d pv = values_of(p), qv = values_of(q);
  const Eigen::Vector3d u = qv - pv;
  const double along = -pv.dot(u);
  const double u2 = u.squaredNorm();
  if (!(along > 0.0 && along < u2)) return;
  const Eigen::Vector3d near = pv + u * (along / u2);
  if (!(near.squaredNorm() < sphere.radius * sphere.radius)) return;

  const Scalar p2 = p.squaredNorm();
  const Scalar q2 = q.squaredNorm();
  const double radius = sphere.radius;
  const Scalar radius2(radius * radius);
  // Normal of the plane, such that the path turns positively about it.
  Vector3 normal = p.cross(q);
  const Scalar normal2 = normal.squaredNorm();
  if (value_of(normal2) < 1e-20 * value_of(p2) * value_of(q2)) {
    Eigen::Vector3d side = Eigen::Vector3d::Unit(sphere.quadrant.sign != 0 ? sphere.quadrant.axis : 0);
    if (sphere.quadrant.sign < 0) side = -side;
    if (pv.cross(side).squaredNorm() < 1e-12 * pv.squaredNorm()) side = Eigen::Vector3d(side.y(), side.z(), side.x());
    normal = p.cross(side.cast<Scalar>());
    normal /= sqrt(normal.squaredNorm());
  } else {
    normal /= sqrt(normal2);
  }
  const Scalar d1 = sqrt(p2 - radius2);
  const Scalar d2 = sqrt(q2 - radius2);
  const auto tangent_points = [&](double turn) {
    result.r1 = p * (radius2 / p2) + normal.cross(p) * (d1 / p2 * Scalar(radius * turn));
    result.r2 = q * (radius2 / q2) - normal.cross(q) * (d2 / q2 * Scalar(radius * turn));
  };
  bool long_way = false;
  tangent_points(1.0);
  if (sphere.quadrant.sign != 0) {
    const auto active = [&](const Vector3& x) {
      return value_of(x[sphere.quadrant.axis]) * sphere.quadrant.sign >= 0.0;
    };
    const Vector3 middle = result.r1 + result.r2;
    if (!active(result.r1) && !active(result.r2) && !active(middle)) {
      tangent_points(-1.0);
      long_way = active(result.r1) || active(result.r2) || active(Vector3(-(result.r1 + result.r2)));
      if (!long_way) tangent_points(1.0);
    }
  }
  const double turn = long_way ? -1.0 : 1.0;
  Scalar angle = atan2(normal.dot(result.r1.cross(result.r2)) * Scalar(turn), result.r1.dot(result.r2));
  if (long_way && angle < Scalar(0.0)) angle += Scalar(kFullTurn);
  result.status = WrapStatus::kWrapped;
  result.surface_length = angle * Scalar(radius);
  result.length = d1 + result.surface_length + d2;
  result.direction1 = (result.r1 - p) / d1;
  result.direction2 = (q - result.r2) / d2;
  result.gradient_p = -result.direction1;
  result.gradient_q = result.direction2;
}

template <typename Scalar>
void wrap_onto(const WrapSphere& sphere, const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& q,
               bool radial, WrapResult<Scalar>& result) {
  const auto w = Eigen::Vector3d::Constant(1.0 / (sphere.radius * sphere.radius)).eval();
  if (!dips_in<Scalar>(w, p, q)) return wrap_outside(sphere, p, q, result);
  wrap_lifted(lift_ends<Scalar>(w, p, q), radial, result,
              [&](const auto& fp, const auto& fq) { wrap_outside<Scalar>(sphere, fp, fq, result); });
}

// In muscle_path_evaluation.cpp.
extern template void wrap_onto<double>(const WrapSphere&, const Eigen::Vector3d&, const Eigen::Vector3d&, bool,
                                       WrapResult<double>&);

}  // namespace internal

/// Shortest path over a sphere about the origin: a great circle in the plane of P, Q and the centre. Closed form.
///
/// Wraps where the segment meets the sphere, the shorter way; with a quadrant, the longer way where the whole shorter
/// arc lies on the inactive side and the longer one does not (a string would slip off there; OpenSim holds it). Where
/// the segment passes through the centre, the plane is the one that contains the quadrant's axis.
template <typename Scalar>
[[nodiscard]] WrapResult<Scalar> wrap(const WrapSphere& sphere, const Eigen::Matrix<Scalar, 3, 1>& p,
                                      const Eigen::Matrix<Scalar, 3, 1>& q) {
  WrapResult<Scalar> result;
  internal::wrap_onto(sphere, p, q, true, result);
  return result;
}

}  // namespace veridyn::muscle
