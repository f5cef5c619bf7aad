#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/wrap_result.hpp"

namespace veridyn::muscle {

/// A sphere about the origin.
struct WrapSphere {
  double radius = 0.0;  ///< [m]
  WrapQuadrant quadrant;
};

namespace internal {

template <typename Scalar>
void wrap_onto(const WrapSphere& sphere, const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& q,
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
  const double gap = (1.0 - kSurfaceGap) * (1.0 - kSurfaceGap);
  Scalar radius2(sphere.radius * sphere.radius);
  const Scalar& nearer2 = p2 < q2 ? p2 : q2;
  const bool inside = value_of(nearer2) * gap < value_of(radius2);
  if (inside) radius2 = nearer2 * Scalar(gap);
  const Scalar radius = inside ? Scalar(sqrt(radius2)) : Scalar(sphere.radius);
  if (inside) {
    result.depth = 1.0 - value_of(radius) / sphere.radius;
    if (result.depth >= kInsideFade) {
      result.status = WrapStatus::kInside;
      return;
    }
  }
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
    result.r1 = p * (radius2 / p2) + normal.cross(p) * (radius * d1 / p2 * Scalar(turn));
    result.r2 = q * (radius2 / q2) - normal.cross(q) * (radius * d2 / q2 * Scalar(turn));
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
  result.surface_length = radius * angle;
  result.length = d1 + result.surface_length + d2;
  result.direction1 = (result.r1 - p) / d1;
  result.direction2 = (q - result.r2) / d2;
  result.gradient_p = -result.direction1;
  result.gradient_q = result.direction2;
  if (inside) {
    const bool end_is_p = p2 < q2;
    const Vector3& end = end_is_p ? p : q;
    const Scalar distance = sqrt(nearer2);
    (end_is_p ? result.gradient_p : result.gradient_q) += end * (angle * Scalar(gap) / radius);
    fade_inside<Scalar>(result, distance / Scalar(sphere.radius), end / (distance * Scalar(sphere.radius)), end_is_p);
  }
}

// In muscle_path_evaluation.cpp.
extern template void wrap_onto<double>(const WrapSphere&, const Eigen::Vector3d&, const Eigen::Vector3d&,
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
  internal::wrap_onto(sphere, p, q, result);
  return result;
}

}  // namespace veridyn::muscle
