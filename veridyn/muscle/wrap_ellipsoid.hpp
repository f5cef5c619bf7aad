#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "veridyn/muscle/wrap_result.hpp"

/// Wrapping over an ellipsoid along its geodesic.
///
/// A geodesic x(s) of x'Ax = 1, A = diag(1/a_i^2), has x'' = -(t'At / |Ax|^2) Ax, and Joachimsthal's invariant
/// C = (t'At) |Ax|^2 makes that x'' = -C |Ax|^-4 Ax: no velocity on the right, so Nystroem's formulas apply. The
/// deviation J of neighbouring geodesics obeys J'' = -K J with K = |Ax|^-4 / (a b c)^2: the same factor, a fourth
/// component of the same system. J = |P r1|, J' = 1 where the path reaches the surface (the cone of tangents from P is
/// rolled onto it), and J + |r2 Q| J' is how far the end at Q moves per radian of the start: the slope of Newton's
/// method for the one unknown, the direction in which the path leaves P. J stays positive on a shortest path.
namespace veridyn::muscle::internal {

/// One shot: the geodesic that starts where angle `alpha` on the circle of tangent points from P says, of length `s`.
template <typename Scalar>
struct GeodesicShot {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  Vector3 r1, r2, t1, t2;
  Scalar length1;
  Scalar jacobi, jacobi_slope;
  Vector3 r1_slope;       ///< dr1 / dalpha
  Scalar angle_slope;     ///< d(angle at P) / dalpha
  Scalar visibility;      ///< Q'A r2 - 1: zero where Q lies in the tangent plane of r2
  Vector3 sideways;       ///< unit, in the tangent plane of r2, across the geodesic
  Vector3 normal2;        ///< A r2
};

/// Frame of the circle of tangent points from P, in coordinates x / a where the ellipsoid is the unit sphere.
template <typename Scalar>
struct TangentCircle {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  Vector3 center, e1, e2;  ///< e1, e2 of the circle's radius
};

template <typename Scalar>
TangentCircle<Scalar> tangent_circle(const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& toward) {
  using std::sqrt;
  TangentCircle<Scalar> circle;
  const Scalar p2 = p.squaredNorm();
  circle.center = p / p2;
  const Scalar radius = sqrt(Scalar(1.0) - Scalar(1.0) / p2);
  const Eigen::Matrix<Scalar, 3, 1> across = toward - p * (p.dot(toward) / p2);
  circle.e1 = across * (radius / sqrt(across.squaredNorm()));
  circle.e2 = p.cross(circle.e1) / sqrt(p2);
  return circle;
}

/// Nystroem's method of order five with four evaluations (Hairer, Norsett, Wanner, Solving ODEs I, table II.14.2) for
/// the geodesic and its Jacobi field.
template <typename Scalar>
void integrate_geodesic(const Eigen::Matrix<Scalar, 4, 1>& lambda, const Eigen::Matrix<Scalar, 3, 1>& inverse_square,
                        const Scalar& s, int steps, Eigen::Matrix<Scalar, 4, 1>& y, Eigen::Matrix<Scalar, 4, 1>& v) {
  using Vector4 = Eigen::Matrix<Scalar, 4, 1>;
  const auto f = [&](const Vector4& at) -> Vector4 {
    const Scalar n0 = at[0] * inverse_square[0];
    const Scalar n1 = at[1] * inverse_square[1];
    const Scalar n2 = at[2] * inverse_square[2];
    const Scalar n = n0 * n0 + n1 * n1 + n2 * n2;
    const Scalar w = Scalar(-1.0) / (n * n);
    return (lambda.cwiseProduct(at) * w).eval();
  };
  const Scalar h = s / Scalar(static_cast<double>(steps));
  const Scalar hh = h * h;
  for (int i = 0; i < steps; ++i) {
    const Vector4 k1 = f(y);
    const Vector4 k2 = f((y + v * (h * Scalar(0.2)) + k1 * (hh * Scalar(1.0 / 50.0))).eval());
    const Vector4 k3 =
        f((y + v * (h * Scalar(2.0 / 3.0)) + (k2 * Scalar(7.0) - k1) * (hh * Scalar(1.0 / 27.0))).eval());
    const Vector4 k4 =
        f((y + v * h + (k1 * Scalar(21.0) - k2 * Scalar(4.0) + k3 * Scalar(18.0)) * (hh * Scalar(1.0 / 70.0))).eval());
    y += v * h + (k1 * Scalar(14.0) + k2 * Scalar(100.0) + k3 * Scalar(54.0)) * (hh * Scalar(1.0 / 336.0));
    v += (k1 * Scalar(14.0) + k2 * Scalar(125.0) + k3 * Scalar(162.0) + k4 * Scalar(35.0)) * (h * Scalar(1.0 / 336.0));
  }
}

template <typename Scalar>
GeodesicShot<Scalar> shoot(const Eigen::Vector3d& a, const Eigen::Matrix<Scalar, 3, 1>& p,
                           const Eigen::Matrix<Scalar, 3, 1>& q, const TangentCircle<Scalar>& circle,
                           const Scalar& cos_alpha, const Scalar& sin_alpha, const Scalar& s, int steps) {
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  GeodesicShot<Scalar> shot;
  const Vector3 as = a.cast<Scalar>();
  const Vector3 inverse_square = a.cwiseProduct(a).cwiseInverse().cast<Scalar>();
  shot.r1 = (circle.center + circle.e1 * cos_alpha + circle.e2 * sin_alpha).cwiseProduct(as);
  shot.r1_slope = (circle.e2 * cos_alpha - circle.e1 * sin_alpha).cwiseProduct(as);
  const Vector3 to_r1 = shot.r1 - p;
  shot.length1 = sqrt(to_r1.squaredNorm());
  shot.t1 = to_r1 / shot.length1;
  const Vector3 n1 = shot.r1.cwiseProduct(inverse_square);
  const Scalar n1_square = n1.squaredNorm();
  const Vector3 b1 = n1.cross(shot.t1) / sqrt(n1_square);
  shot.angle_slope = shot.r1_slope.dot(b1) / shot.length1;
  const Scalar invariant = n1_square * shot.t1.dot(shot.t1.cwiseProduct(inverse_square));
  const double abc = a.x() * a.y() * a.z();
  Eigen::Matrix<Scalar, 4, 1> lambda;
  lambda << invariant * inverse_square.x(), invariant * inverse_square.y(), invariant * inverse_square.z(),
      Scalar(1.0 / (abc * abc));
  Eigen::Matrix<Scalar, 4, 1> y, v;
  y << shot.r1.x(), shot.r1.y(), shot.r1.z(), shot.length1;
  v << shot.t1.x(), shot.t1.y(), shot.t1.z(), Scalar(1.0);
  integrate_geodesic<Scalar>(lambda, inverse_square, s, steps, y, v);
  shot.r2 = y.template head<3>();
  shot.t2 = v.template head<3>();
  shot.jacobi = y[3];
  shot.jacobi_slope = v[3];
  shot.normal2 = shot.r2.cwiseProduct(inverse_square);
  shot.visibility = shot.normal2.dot(q) - Scalar(1.0);
  shot.sideways = shot.normal2.cross(shot.t2) / sqrt(shot.normal2.squaredNorm());
  return shot;
}

}  // namespace veridyn::muscle::internal
