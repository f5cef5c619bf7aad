#include "veridyn/muscle/path/wrap_ellipsoid.hpp"

namespace veridyn::muscle::internal {
namespace {

constexpr double kFineStep = 0.15;  ///< of the integration [smallest radius]
constexpr double kCoarseStep = 0.35;

/// Newton's method on (angle at P, s): coarse shots until the corrections are small, then fine ones. The last
/// correction is left to the caller; what remains after it is its square.
void newton(const Eigen::Vector3d& a, const Spheroid& spheroid, const Eigen::Vector3d& p, const Eigen::Vector3d& q,
            const TangentCircle<double>& circle, double tolerance, SolvedGeodesic& solution) {
  const double size = a.maxCoeff();
  const Eigen::Vector3d inverse_square = a.cwiseProduct(a).cwiseInverse();
  const double radius = a.minCoeff();
  double alpha = solution.alpha;
  double s = solution.s;
  // Quadrature has no coarse steps that would be cheaper.
  bool is_fine = solution.converged || spheroid.axis >= 0;
  solution.converged = false;
  for (int i = 0; i < 30; ++i) {
    solution.steps = std::clamp(1 + static_cast<int>(s / (radius * (is_fine ? kFineStep : kCoarseStep))), 1, 100);
    solution.shot = shoot<double>(a, spheroid, p, q, circle, std::cos(alpha), std::sin(alpha), s, solution.steps);
    solution.last = correction<double>(solution.shot, inverse_square, q);
    const ShotCorrection<double>& c = solution.last;
    solution.iterations = i + 1;
    if (!std::isfinite(c.angle) || !std::isfinite(c.s)) return;
    // Where J < 0 the length has a maximum: the other direction leads to a shortest path.
    const double towards_less = c.jacobi > 0.0 ? c.angle : -c.angle;
    const double d_alpha = std::clamp(towards_less / solution.shot.angle_slope, -0.5, 0.5);
    const double d_s = std::clamp(c.s, -0.4 * size, 0.4 * size);
    solution.alpha = alpha;
    solution.s = s;
    solution.length = solution.shot.length1 + solution.shot.surface + c.length2;
    solution.jacobi = c.jacobi;
    const double step = std::max(std::abs(d_alpha), std::abs(d_s) / size);
    // The last correction leaves about step^2 size of the tangent points, of the directions that over the straight
    // part.
    const double straight = std::min(solution.shot.length1, c.length2) / size;
    const double focus = std::min(1.0, std::max(0.0, 2.5 * c.jacobi / solution.length));
    if (is_fine && step < 0.5 * tolerance && step * step < tolerance * tolerance * straight * focus * focus &&
        c.reached) {
      solution.middle = solution.shot.r1 + solution.shot.r2;
      solution.converged = c.jacobi > 0.0;
      return;
    }
    if (step < 5e-3) is_fine = true;
    alpha += d_alpha;
    s = std::max(1e-12 * size, s + d_s / solution.shot.speed);
  }
}

/// From a converged solution for nearby ends, on the same side.
SolvedGeodesic resolve_geodesic(const Eigen::Vector3d& a, const Spheroid& spheroid, const Eigen::Vector3d& p,
                                const Eigen::Vector3d& q, const GeodesicSolution& nearby, double tolerance) {
  SolvedGeodesic solution;
  static_cast<GeodesicSolution&>(solution) = nearby;
  const TangentCircle<double> circle = tangent_circle<double>(p.cwiseQuotient(a), nearby.toward);
  newton(a, spheroid, p, q, circle, tolerance, solution);
  return solution;
}

}  // namespace

EllipsoidPass ellipsoid_pass(const WrapEllipsoid& ellipsoid, const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  EllipsoidPass pass;
  const Eigen::Vector3d ps = p.cwiseQuotient(ellipsoid.radii), qs = q.cwiseQuotient(ellipsoid.radii);
  pass.along = qs - ps;
  const double u2 = pass.along.squaredNorm();
  const double along = -ps.dot(pass.along);
  if (!(along > 0.0 && along < u2)) return pass;
  pass.toward = ps + pass.along * (along / u2);
  pass.distance2 = pass.toward.squaredNorm();
  if (!(pass.distance2 < 1.0)) return pass;
  if (pass.distance2 < 1e-24) {
    Eigen::Vector3d& near = pass.toward;
    near = Eigen::Vector3d::Unit(ellipsoid.quadrant.sign != 0 ? ellipsoid.quadrant.axis : 0);
    if (ellipsoid.quadrant.sign < 0) near = -near;
    if (near.cross(ps).squaredNorm() < 1e-8 * ps.squaredNorm()) near = Eigen::Vector3d(near.y(), near.z(), near.x());
  }
  pass.status = WrapStatus::kWrapped;
  return pass;
}

SolvedGeodesic solve_geodesic(const Eigen::Vector3d& a, const Spheroid& spheroid, const Eigen::Vector3d& p,
                              const Eigen::Vector3d& q, const Eigen::Vector3d& toward, double tolerance) {
  SolvedGeodesic solution;
  const Eigen::Vector3d ps = p.cwiseQuotient(a), qs = q.cwiseQuotient(a);
  const TangentCircle<double> circle = tangent_circle<double>(ps, toward);
  const TangentCircle<double> far_circle = tangent_circle<double>(qs, toward);
  const Eigen::Vector3d y1 = circle.center + circle.e1;
  const Eigen::Vector3d y2 = far_circle.center + far_circle.e1;
  Eigen::Vector3d y_slope = y1 - ps;
  y_slope = (y_slope - y1 * y_slope.dot(y1)).normalized();
  const double arc = std::max(0.0, std::atan2(y2.dot(y_slope), y2.dot(y1)));
  if (spheroid.axis >= 0) {
    solution.s = arc;
  } else {
    // Length of the ellipse between them by Simpson's rule.
    const double half_sine = std::sin(0.5 * arc), half_cosine = std::cos(0.5 * arc);
    const Eigen::Vector3d mid = (y_slope * half_cosine - y1 * half_sine).cwiseProduct(a);
    const double sine = 2.0 * half_sine * half_cosine, cosine = 1.0 - 2.0 * half_sine * half_sine;
    const Eigen::Vector3d end = (y_slope * cosine - y1 * sine).cwiseProduct(a);
    solution.s = arc * (y_slope.cwiseProduct(a).norm() + 4.0 * mid.norm() + end.norm()) / 6.0;
  }
  solution.toward = toward;
  newton(a, spheroid, p, q, circle, tolerance, solution);
  return solution;
}

SolvedGeodesic find_geodesic(const WrapEllipsoid& ellipsoid, const EllipsoidPass& pass, const Eigen::Vector3d& a,
                             const Spheroid& spheroid, const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                             const GeodesicSolution* nearby, double tolerance) {
  SolvedGeodesic solution;
  if (nearby != nullptr) solution = resolve_geodesic(a, spheroid, p, q, *nearby, tolerance);
  if (!solution.converged) solution = solve_geodesic(a, spheroid, p, q, pass.toward, tolerance);
  // Where the segment passes near the centre either side may be the shorter; a path that focuses strongly (J well below
  // the length) may have a shorter neighbour on either side.
  const bool may_be_longer =
      nearby == nullptr && (pass.distance2 < 0.01 || solution.jacobi < 0.4 * solution.length || ellipsoid.side != 0);
  if (solution.converged && !may_be_longer) return solution;
  const auto good = [&](const SolvedGeodesic& s) {
    return s.converged &&
           (ellipsoid.side == 0 || on_inactive_side(ellipsoid.quadrant, s.middle) == (ellipsoid.side < 0));
  };
  const Eigen::Vector3d& near = pass.toward;
  const Eigen::Vector3d across = pass.along.cross(near).normalized() * near.norm();
  bool have = good(solution);
  for (const Eigen::Vector3d& toward : {Eigen::Vector3d(near + across), Eigen::Vector3d(near - across),
                                        Eigen::Vector3d(across - near), Eigen::Vector3d(-across - near)}) {
    const SolvedGeodesic other = solve_geodesic(a, spheroid, p, q, toward, tolerance);
    if (!good(other) && !(other.converged && !solution.converged)) continue;
    if (have && !(other.length < solution.length)) continue;
    solution = other;
    have = good(other);
  }
  return solution;
}

}  // namespace veridyn::muscle::internal
