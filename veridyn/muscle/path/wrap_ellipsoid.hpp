#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "veridyn/muscle/path/geodesic_spheroid.hpp"
#include "veridyn/muscle/path/wrap_lift.hpp"
#include "veridyn/muscle/path/wrap_result.hpp"
#include "veridyn/numerics/runge_kutta_nystrom.hpp"

/// Wrapping over an ellipsoid along its geodesic.
///
/// A geodesic x(s) of x'Ax = 1, A = diag(1/a_i^2), has x'' = -(t'At / |Ax|^2) Ax, and Joachimsthal's invariant
/// C = (t'At) |Ax|^2 makes that x'' = -C |Ax|^-4 Ax: no velocity on the right, so Nystroem's formulas apply. The
/// deviation J of neighbouring geodesics obeys J'' = -K J with K = |Ax|^-4 / (a b c)^2: the same factor, a fourth
/// component of the same system. J = |P r1|, J' = 1 where the path reaches the surface (the cone of tangents from P is
/// rolled onto it), and J + |r2 Q| J' is how far the end at Q moves per radian of the start: the slope of Newton's
/// method for the one unknown, the direction in which the path leaves P. J stays positive on a shortest path.
namespace veridyn::muscle::internal {

/// One shot: the geodesic that starts where angle `alpha` on the circle of tangent points from P says, as far as the
/// parameter `s`: its length, on a spheroid the arc of its auxiliary sphere.
template <typename Scalar>
struct GeodesicShot {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  Vector3 r1, r2, t1, t2;
  Scalar length1;
  Scalar surface;  ///< length from r1 to r2
  Scalar speed;    ///< d surface / ds
  Scalar jacobi, jacobi_slope;
  Vector3 r1_slope;    ///< dr1 / dalpha
  Scalar angle_slope;  ///< d(angle at P) / dalpha
  Scalar visibility;   ///< Q'A r2 - 1: zero where Q lies in the tangent plane of r2
  Vector3 sideways;    ///< unit, in the tangent plane of r2, across the geodesic
  Vector3 normal2;     ///< A r2
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

/// The geodesic and its Jacobi field by `numerics::nystrom_5_steps`.
template <typename Scalar>
void integrate_geodesic(const Eigen::Matrix<Scalar, 4, 1>& lambda, const Eigen::Matrix<Scalar, 3, 1>& inverse_square,
                        const Scalar& s, int steps, Eigen::Matrix<Scalar, 4, 1>& y, Eigen::Matrix<Scalar, 4, 1>& v) {
  const Scalar h = s / Scalar(static_cast<double>(steps));
  const Scalar hh = -h * h;
  const Scalar l0 = lambda[0] * hh, l1 = lambda[1] * hh, l2 = lambda[2] * hh, l3 = lambda[3] * hh;
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): scalars in registers, see above
  const Scalar i0 = inverse_square[0], i1 = inverse_square[1], i2 = inverse_square[2];
  const auto f = [&](const Scalar* at, Scalar* k) {
    const Scalar n0 = at[0] * i0, n1 = at[1] * i1, n2 = at[2] * i2;
    const Scalar n = n0 * n0 + n1 * n1 + n2 * n2;
    const Scalar w = Scalar(1.0) / (n * n);
    k[0] = l0 * at[0] * w;
    k[1] = l1 * at[1] * w;
    k[2] = l2 * at[2] * w;
    k[3] = l3 * at[3] * w;
  };
  Scalar x[4], u[4];
  for (int c = 0; c < 4; ++c) {
    x[c] = y[c];
    u[c] = v[c] * h;
  }
  numerics::nystrom_5_steps<4>(f, steps, x, u);
  const Scalar per_h = Scalar(1.0) / h;
  for (int c = 0; c < 4; ++c) {
    y[c] = x[c];
    v[c] = u[c] * per_h;
  }
}

template <typename Scalar>
GeodesicShot<Scalar> shoot(const Eigen::Vector3d& a, const Spheroid& spheroid, const Eigen::Matrix<Scalar, 3, 1>& p,
                           const Eigen::Matrix<Scalar, 3, 1>& q, const TangentCircle<Scalar>& circle,
                           const Scalar& cos_alpha, const Scalar& sin_alpha, const Scalar& s, int steps) {
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  GeodesicShot<Scalar> shot;
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): a copy for derivatives, a reference for double
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
  if (spheroid.axis >= 0) {
    const SpheroidArrival<Scalar> end = spheroid_geodesic<Scalar>(spheroid, a, shot.r1, shot.t1, shot.length1, s);
    shot.r2 = end.position;
    shot.t2 = end.direction;
    shot.jacobi = end.jacobi;
    shot.jacobi_slope = end.jacobi_slope;
    shot.surface = end.length;
    shot.speed = end.speed;
  } else {
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
    shot.surface = s;
    shot.speed = Scalar(1.0);
  }
  shot.normal2 = shot.r2.cwiseProduct(inverse_square);
  shot.visibility = shot.normal2.dot(q) - Scalar(1.0);
  shot.sideways = shot.normal2.cross(shot.t2) / sqrt(shot.normal2.squaredNorm());
  return shot;
}

}  // namespace veridyn::muscle::internal

namespace veridyn::muscle {

/// An ellipsoid x^2/a^2 + y^2/b^2 + z^2/c^2 = 1 about the origin.
struct WrapEllipsoid {
  Eigen::Vector3d radii = Eigen::Vector3d::Zero();  ///< [m]
  WrapQuadrant quadrant;
  /// +1, -1: of several shortest geodesics the one on this side of the quadrant's plane if there is one; 0: the
  /// shortest of all.
  int side = 0;
};

namespace internal {

/// Shape of a solution in double: what a last step in any scalar starts from.
struct GeodesicSolution {
  bool converged = false;
  Eigen::Vector3d toward = Eigen::Vector3d::Zero();  ///< in x / a: direction of alpha = 0
  double alpha = 0.0;
  double s = 0.0;
  double length = 0.0;
  double jacobi = 0.0;  ///< at Q: positive on a shortest path
  int steps = 4;
  int iterations = 0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
};

/// Solutions of one object for ends that converge: each starts from the one before.
struct GeodesicMemory {
  GeodesicSolution nearby;
  bool no_other = false;  ///< there is none on the quadrant's other side

  void clear() {
    nearby.converged = false;
    no_other = false;
  }
};

/// Correction of (angle at P, s) after a shot, and |r2 Q|.
template <typename Scalar>
struct ShotCorrection {
  Scalar angle, s, length2, jacobi;
  bool reached = true;  ///< false: Q is never in the tangent plane; `s` leads to where it is nearest to that
};

template <typename Scalar>
ShotCorrection<Scalar> correction(const GeodesicShot<Scalar>& shot, const Eigen::Vector3d& inverse_square,
                                  const Eigen::Matrix<Scalar, 3, 1>& q) {
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  ShotCorrection<Scalar> c;
  const Vector3 to_q = q - shot.r2;
  const Scalar miss = to_q.dot(shot.sideways);
  c.length2 = to_q.dot(shot.t2);
  c.jacobi = shot.jacobi + c.length2 * shot.jacobi_slope;
  c.angle = miss / c.jacobi;
  // Along the geodesic, Q'A r2 - 1 vanishes to second order in s where Q is near the surface: solve the quadratic.
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): a copy for derivatives, a reference for double
  const Vector3 inverse = inverse_square.cast<Scalar>();
  const Vector3 aq = q.cwiseProduct(inverse);
  const Scalar value = shot.visibility + shot.jacobi * c.angle * shot.sideways.dot(aq);
  const Scalar slope = shot.t2.dot(aq);
  const Scalar bend = -shot.t2.dot(shot.t2.cwiseProduct(inverse)) / shot.normal2.squaredNorm() * shot.normal2.dot(aq);
  const Scalar discriminant = slope * slope - Scalar(2.0) * bend * value;
  if (value_of(bend) >= 0.0) {
    c.s = -value / slope;
  } else if (value_of(discriminant) > 0.0) {
    c.s = (sqrt(discriminant) - slope) / bend;
  } else {
    c.s = -slope / bend;
    c.reached = false;
  }
  return c;
}

/// What a warm start of the next, similar solution needs, and the last shot of this one.
struct SolvedGeodesic : GeodesicSolution {
  GeodesicShot<double> shot;
  ShotCorrection<double> last;
};

/// How a segment with both ends outside passes an ellipsoid, in coordinates x / radii where the ellipsoid is the unit
/// sphere.
struct EllipsoidPass {
  WrapStatus status = WrapStatus::kStraight;         ///< kWrapped: there is a geodesic to be found
  Eigen::Vector3d along = Eigen::Vector3d::Zero();   ///< from P to Q
  Eigen::Vector3d toward = Eigen::Vector3d::Zero();  ///< from the centre to the segment's nearest point
  double distance2 = 0.0;                            ///< of that point from the centre, squared
};

[[nodiscard]] EllipsoidPass ellipsoid_pass(const WrapEllipsoid& ellipsoid, const Eigen::Vector3d& p,
                                           const Eigen::Vector3d& q);

/// On the side of a quadrant's plane where nothing wraps.
inline bool on_inactive_side(const WrapQuadrant& quadrant, const Eigen::Vector3d& x) {
  return x[quadrant.axis] * (quadrant.sign < 0 ? -1 : 1) < 0.0;
}

/// From the ellipse through `toward` and the centre. `p`, `q` outside the ellipsoid.
[[nodiscard]] SolvedGeodesic solve_geodesic(const Eigen::Vector3d& a, const Spheroid& spheroid,
                                            const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                                            const Eigen::Vector3d& toward, double tolerance);

/// The shortest geodesic, on the side of `ellipsoid.side` where that has one. Starts from `nearby` unless null.
[[nodiscard]] SolvedGeodesic find_geodesic(const WrapEllipsoid& ellipsoid, const EllipsoidPass& pass,
                                           const Eigen::Vector3d& a, const Spheroid& spheroid, const Eigen::Vector3d& p,
                                           const Eigen::Vector3d& q, const GeodesicSolution* nearby, double tolerance);

/// Newton's last step, in `Scalar`: tangent points and the whole length.
///
/// The tangent points are left with an error of the step's square. The length of the shot and of the straight line from
/// its end to Q, which meet at an angle, is stationary in that end but for the angle: half of what the step would gain
/// at its first slope leaves an error of the step's cube.
template <typename Scalar>
void last_step(const SolvedGeodesic& from, const Eigen::Vector3d& a, const Spheroid& spheroid,
               const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& q, WrapResult<Scalar>& result) {
  const auto take = [&](const GeodesicShot<Scalar>& shot, const ShotCorrection<Scalar>& c) {
    const Scalar d_alpha = c.angle / shot.angle_slope;
    result.r1 = shot.r1 + shot.r1_slope * d_alpha;
    result.r2 = shot.r2 + shot.sideways * (shot.jacobi * c.angle) + shot.t2 * c.s;
    if constexpr (std::is_same_v<Scalar, double>) {
      const Eigen::Vector3d way = q - shot.r2;
      const double straight = way.norm();
      result.length =
          shot.length1 + shot.surface + straight + 0.5 * (shot.t2 - way / straight).dot(result.r2 - shot.r2);
    } else {
      result.surface_length = shot.surface + c.s - shot.t1.dot(shot.r1_slope) * d_alpha;
    }
  };
  if constexpr (std::is_same_v<Scalar, double>) {
    take(from.shot, from.last);
  } else {
    const Eigen::Matrix<Scalar, 3, 1> ps = p.cwiseQuotient(a.cast<Scalar>().eval());
    const TangentCircle<Scalar> circle = tangent_circle<Scalar>(ps, from.toward.cast<Scalar>().eval());
    const GeodesicShot<Scalar> shot = shoot<Scalar>(a, spheroid, p, q, circle, Scalar(std::cos(from.alpha)),
                                                    Scalar(std::sin(from.alpha)), Scalar(from.s), from.steps);
    take(shot, correction<Scalar>(shot, a.cwiseProduct(a).cwiseInverse(), q));
  }
}

/// Both ends outside.
template <typename Scalar>
void wrap_outside(const WrapEllipsoid& ellipsoid, const Eigen::Matrix<Scalar, 3, 1>& p,
                  const Eigen::Matrix<Scalar, 3, 1>& q, GeodesicMemory* memory, WrapResult<Scalar>& result) {
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  result.clear();
  const Eigen::Vector3d pv = values_of(p), qv = values_of(q);
  const EllipsoidPass pass = ellipsoid_pass(ellipsoid, pv, qv);
  result.status = pass.status;
  if (!result.wrapped()) return;
  const Eigen::Vector3d& a = ellipsoid.radii;
  const Spheroid spheroid = internal::spheroid(a);
  // Derivatives are taken at the last shot: it has to be closer to the solution for them.
  constexpr double tolerance = std::is_same_v<Scalar, double> ? 1e-3 : 1e-7;
  const bool warm = memory != nullptr && memory->nearby.converged;
  const SolvedGeodesic solution =
      find_geodesic(ellipsoid, pass, a, spheroid, pv, qv, warm ? &memory->nearby : nullptr, tolerance);
  if (!solution.converged) {
    result.status = WrapStatus::kFailed;
    return;
  }
  last_step(solution, a, spheroid, p, q, result);
  if (memory != nullptr) memory->nearby = solution;
  result.spread = solution.jacobi / solution.length;
  const auto inactive = [&](const Eigen::Vector3d& x) { return on_inactive_side(ellipsoid.quadrant, x); };
  if (ellipsoid.quadrant.sign != 0 && ellipsoid.side == 0 && inactive(values_of(result.r1)) &&
      inactive(values_of(result.r2)) && inactive(solution.middle) && !(warm && memory->no_other)) {
    const SolvedGeodesic other = solve_geodesic(a, spheroid, pv, qv, Eigen::Vector3d(-solution.toward), tolerance);
    const bool found = other.converged && !inactive(other.middle);
    if (found) last_step(other, a, spheroid, p, q, result);
    if (memory != nullptr) memory->no_other = !found;
  }
  const Vector3 in = result.r1 - p;
  const Vector3 out = q - result.r2;
  const Scalar length1 = sqrt(in.squaredNorm());
  const Scalar length2 = sqrt(out.squaredNorm());
  result.direction1 = in / length1;
  result.direction2 = out / length2;
  if constexpr (std::is_same_v<Scalar, double>) {
    result.surface_length = result.length - length1 - length2;
  } else {
    result.length = length1 + result.surface_length + length2;
  }
  result.gradient_p = -result.direction1;
  result.gradient_q = result.direction2;
}

template <typename Scalar>
void wrap_onto(const WrapEllipsoid& ellipsoid, const Eigen::Matrix<Scalar, 3, 1>& p,
               const Eigen::Matrix<Scalar, 3, 1>& q, bool radial, GeodesicMemory* memory, WrapResult<Scalar>& result) {
  const Eigen::Vector3d w = ellipsoid.radii.cwiseAbs2().cwiseInverse();
  if (!dips_in<Scalar>(w, p, q)) return wrap_outside(ellipsoid, p, q, memory, result);
  wrap_lifted(lift_ends<Scalar>(w, p, q), radial, result,
              [&](const auto& fp, const auto& fq) { wrap_outside<Scalar>(ellipsoid, fp, fq, memory, result); });
}

// In muscle_path_evaluation.cpp.
extern template GeodesicShot<double> shoot<double>(const Eigen::Vector3d&, const Spheroid&, const Eigen::Vector3d&,
                                                   const Eigen::Vector3d&, const TangentCircle<double>&, const double&,
                                                   const double&, const double&, int);
extern template void wrap_onto<double>(const WrapEllipsoid&, const Eigen::Vector3d&, const Eigen::Vector3d&, bool,
                                       GeodesicMemory*, WrapResult<double>&);

}  // namespace internal

/// Geodesic wrap. Wraps where the segment meets the ellipsoid, along the shortest geodesic; with a quadrant, along the
/// one on the other side where that is a shortest path too and this one lies on the inactive side as a whole.
///
/// Newton's method on one angle, usually 3 to 5 shots, and one more step in `Scalar` (so that derivatives are those of
/// the solution). Directions are accurate to about 1e-6, 1e-5 where an end nearly touches the surface. Lengths over a
/// spheroid (quadrature, `geodesic_spheroid.hpp`) to about 3e-9 m at anatomical sizes, over three unequal radii
/// (integration in steps) to 1e-8 m. `memory`: a solution in it starts the search, and the new one
/// is stored there.
template <typename Scalar>
[[nodiscard]] WrapResult<Scalar> wrap(const WrapEllipsoid& ellipsoid, const Eigen::Matrix<Scalar, 3, 1>& p,
                                      const Eigen::Matrix<Scalar, 3, 1>& q,
                                      internal::GeodesicMemory* memory = nullptr) {
  WrapResult<Scalar> result;
  internal::wrap_onto(ellipsoid, p, q, true, memory, result);
  return result;
}

}  // namespace veridyn::muscle
