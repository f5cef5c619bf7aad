#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "veridyn/muscle/path/wrap_cylinder.hpp"

namespace veridyn::muscle {

/// A ring about z: a tube of radius `tube_radius` along the circle of radius `ring_radius`. The path runs through it.
///
/// OpenSim's `inner_radius` is the tube's and `outer_radius` the ring's, whatever the names suggest: so its wrapping
/// code uses them, and so do we.
struct WrapTorus {
  double tube_radius = 0.0;
  double ring_radius = 0.0;
  WrapQuadrant quadrant;
};

namespace internal {

/// Wraps over the tube's tangent cylinder at `angle` of the ring, kept on the side of the hole.
template <typename Scalar>
WrapResult<Scalar> wrap_tube(const WrapTorus& torus, const Eigen::Matrix<Scalar, 3, 1>& p,
                             const Eigen::Matrix<Scalar, 3, 1>& q, const Scalar& angle) {
  using std::cos;
  using std::sin;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  // Cylinder axes: x towards the centre of the ring, z along the ring.
  const Scalar c = cos(angle), s = sin(angle);
  const Vector3 x(-c, -s, Scalar(0.0));
  const Vector3 y(Scalar(0.0), Scalar(0.0), Scalar(-1.0));
  const Vector3 z(s, -c, Scalar(0.0));
  const Vector3 center = x * Scalar(-torus.ring_radius);
  const auto in = [&](const Vector3& v) { return Vector3(x.dot(v - center), y.dot(v), z.dot(v - center)); };
  const auto turn = [&](const Vector3& v) { return Vector3(x * v.x() + y * v.y() + z * v.z()); };
  const WrapCylinder tube{torus.tube_radius, 1.0e3 * torus.ring_radius, {0, 1}};
  WrapResult<Scalar> result = wrap(tube, Vector3(in(p)), Vector3(in(q)));
  if (!result.wrapped()) return result;
  result.r1 = turn(result.r1) + center;
  result.r2 = turn(result.r2) + center;
  result.direction1 = turn(result.direction1);
  result.direction2 = turn(result.direction2);
  result.gradient_p = turn(result.gradient_p);
  result.gradient_q = turn(result.gradient_q);
  return result;
}

/// dL/dangle: turning the tube by an angle is turning P and Q back.
template <typename Scalar>
Scalar tube_slope(const WrapResult<Scalar>& result, const Eigen::Matrix<Scalar, 3, 1>& p,
                  const Eigen::Matrix<Scalar, 3, 1>& q) {
  return -(result.gradient_p.y() * p.x() - result.gradient_p.x() * p.y()) -
         (result.gradient_q.y() * q.x() - result.gradient_q.x() * q.y());
}

}  // namespace internal

/// Path through a ring. It bends over the tube's tangent cylinder, at that angle of the ring where the length is
/// stationary (the string does not slide along the ring); OpenSim takes the angle of the point nearest to the segment,
/// where it does slide. Good while the contact is short against the ring. A quadrant confines that angle's half.
template <typename Scalar>
[[nodiscard]] WrapResult<Scalar> wrap(const WrapTorus& torus, const Eigen::Matrix<Scalar, 3, 1>& p,
                                      const Eigen::Matrix<Scalar, 3, 1>& q) {
  WrapResult<Scalar> result;
  const Eigen::Vector3d pv = values_of(p), qv = values_of(q);
  // The segment has to pass the plane of the ring. Its nearest point to the ring's circle starts the search.
  if (!(pv.z() * qv.z() < 0.0)) return result;
  const double t = pv.z() / (pv.z() - qv.z());
  const Eigen::Vector3d at = pv + t * (qv - pv);
  if (at.head<2>().squaredNorm() < 1e-20) return result;
  if (torus.quadrant.sign != 0 && torus.quadrant.sign * at[torus.quadrant.axis] < 0.0) return result;
  double angle = std::atan2(at.y(), at.x());
  double step = 1e-3;
  WrapResult<double> here = internal::wrap_tube<double>(torus, pv, qv, angle);
  if (!here.wrapped()) {
    result.status = here.status;
    return result;
  }
  double slope = internal::tube_slope<double>(here, pv, qv);
  double curvature = 0.0;
  for (int i = 0; i < 40; ++i) {
    const WrapResult<double> next = internal::wrap_tube<double>(torus, pv, qv, angle + step);
    if (!next.wrapped()) {
      step *= 0.25;
      continue;
    }
    const double next_slope = internal::tube_slope<double>(next, pv, qv);
    if (step != 0.0) curvature = (next_slope - slope) / step;
    angle += step;
    slope = next_slope;
    if (std::abs(step) < 1e-9) break;
    // The obstacle is highest where the length is greatest.
    step = std::clamp(curvature < 0.0 ? -slope / curvature : (slope > 0.0 ? 0.1 : -0.1), -0.2, 0.2);
  }
  if (!(std::abs(slope) < 1e-7 * torus.ring_radius) || !(curvature < 0.0)) {
    result.status = WrapStatus::kFailed;  // the string slides off along the ring
    return result;
  }
  if constexpr (std::is_same_v<Scalar, double>) {
    return internal::wrap_tube<double>(torus, p, q, angle);
  } else {
    const Scalar fixed(angle);
    const Scalar residual = internal::tube_slope<Scalar>(internal::wrap_tube<Scalar>(torus, p, q, fixed), p, q);
    const double h = 1e-5;
    const auto slope_at = [&](double x) {
      return internal::tube_slope<double>(internal::wrap_tube<double>(torus, pv, qv, x), pv, qv);
    };
    const double bend = (slope_at(angle + h) - slope_at(angle - h)) / (2.0 * h);
    return internal::wrap_tube<Scalar>(torus, p, q, Scalar(fixed - residual / Scalar(bend)));
  }
}

}  // namespace veridyn::muscle
