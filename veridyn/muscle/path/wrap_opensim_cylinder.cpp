// OpenSim's cylinder.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/wrap_opensim_parts.hpp"

namespace veridyn::muscle::internal {
namespace {

using Eigen::Vector3d;

Vector3d radial(const Vector3d& x) { return {x.x(), x.y(), 0.0}; }

/// Moves `r` along the axis where the straight part and the spiral's first chord differ in slope by over 0.1 degree.
bool shift_tangent_point(const Vector3d& p, Vector3d& r, const Vector3d& w) {
  const Vector3d in = (r - p).normalized();
  const Vector3d on = (w - r).normalized();
  if (!(std::abs(std::acos(std::clamp(in.z(), -1.0, 1.0)) - std::acos(std::clamp(on.z(), -1.0, 1.0))) > 0.1 * kDegree))
    return false;
  // Where the line p-w passes the line through the feet of p and w on the axis-parallel through r.
  // Both feet lie on one line parallel to the axis; the nearest points of p-w to it:
  const Vector3d u = w - p;
  const Vector3d across = radial(u);
  const double s = across.squaredNorm() > 0.0 ? -radial(p - r).dot(across) / across.squaredNorm() : 0.0;
  r.z() += 1.5 * (p.z() + s * u.z() - r.z());
  return true;
}

/// The two tangent points of an end, on the circle at its height.
struct TangentPair {
  Vector3d a, b;
};
TangentPair tangents(double radius, const Vector3d& end) {
  const Vector3d radial_part = radial(end);
  const double distance = radial_part.norm();
  const Vector3d v = radial_part / distance;
  const double along = radius * radius / distance;
  const double aside = std::sqrt(std::max(0.0, radius * radius - along * along));
  const Vector3d u = Vector3d::UnitZ().cross(v);
  const Vector3d foot{0.0, 0.0, end.z()};
  return {foot + along * v + aside * u, foot + along * v - aside * u};
}

/// Which tangent points the path takes.
struct TangentChoice {
  Vector3d r1, r2;
  bool far_side = false;
  bool long_wrap = false;
};

/// Without a quadrant: those nearest to each other in direction.
TangentChoice nearest_tangents(const TangentPair& at_p, const TangentPair& at_q) {
  const std::array<double, 4> dots{radial(at_p.a).dot(radial(at_q.a)), radial(at_p.a).dot(radial(at_q.b)),
                                   radial(at_p.b).dot(radial(at_q.a)), radial(at_p.b).dot(radial(at_q.b))};
  const auto best = std::max_element(dots.begin(), dots.end()) - dots.begin();
  return {best < 2 ? at_p.a : at_p.b, best % 2 == 0 ? at_q.a : at_q.b};
}

/// With a quadrant: those on its active side.
TangentChoice tangents_on_side(const WrapQuadrant& quadrant, const Vector3d& p, const Vector3d& q,
                               const TangentPair& at_p, const TangentPair& at_q) {
  const double s = quadrant.sign;
  const int axis = quadrant.axis;
  const double alpha = angle_between(radial(at_p.a), radial(at_q.b));
  const double beta = angle_between(radial(at_p.b), radial(at_q.a));
  const bool a1 = sign_of(at_p.a[axis]) == s;
  const bool b1 = sign_of(at_p.b[axis]) == s;
  bool take_a = false;  // a of p with b of q; otherwise b of p with a of q
  bool none_active = false;
  if (a1 != b1) {
    take_a = a1;
  } else if (a1) {
    take_a = sign_of(at_q.a[axis]) != s;
  } else if (sign_of(at_q.a[axis]) == s) {
    take_a = false;
  } else if (sign_of(at_q.b[axis]) == s) {
    take_a = true;
  } else {
    take_a = alpha > beta;
    none_active = true;
  }
  TangentChoice choice{take_a ? at_p.a : at_p.b, take_a ? at_q.b : at_q.a};
  choice.far_side = none_active || (take_a == (alpha > beta));
  const Vector3d outward = (choice.r1 - p) + (choice.r2 - q);
  choice.long_wrap = (radial(choice.r1) + radial(choice.r2)).dot(outward) < 0.0;
  return choice;
}

/// Slides both tangent points along the axis into the plane of p, q and an apex.
void slide_into_plane(double radius, const Vector3d& p, const Vector3d& q, TangentChoice& choice) {
  const double p_distance = radial(p).norm();
  const double q_distance = radial(q).norm();
  const double t_apex = p_distance / (p_distance + q_distance);
  const Vector3d middle = p + t_apex * (q - p);
  const Vector3d foot{0.0, 0.0, middle.z()};
  const Vector3d normal = (p - foot).normalized().cross((q - foot).normalized()).normalized();
  const Vector3d apex1 = foot + radius * Vector3d::UnitZ().cross(normal).normalized();
  const Vector3d apex2 = foot - radius * Vector3d::UnitZ().cross(normal).normalized();
  const bool first_nearer = (middle - apex1).squaredNorm() < (middle - apex2).squaredNorm();
  const Vector3d apex = first_nearer != choice.far_side ? apex1 : apex2;
  const Vector3d cut = (p - apex).normalized().cross((q - apex).normalized()).normalized();
  const double low = std::min(p.z(), q.z());
  const double high = std::max(p.z(), q.z());
  for (Vector3d* r : {&choice.r1, &choice.r2}) {
    if (std::abs(20.0 * cut.z()) < 1e-5) continue;
    const double z = r->z() - cut.dot(*r - p) / cut.z();
    if (z > low && z < high) r->z() = z;
  }
}

/// Length of the spiral; tangent points are shifted along the axis unless this is the path's only wrap.
double spiral_length(double radius, bool only_wrap_of_path, const Vector3d& p, const Vector3d& q,
                     TangentChoice& choice) {
  Vector3d& r1 = choice.r1;
  Vector3d& r2 = choice.r2;
  for (int iteration = 0;; ++iteration) {
    double theta = angle_between(radial(r1), radial(r2));
    if (choice.long_wrap) theta = kFullTurn - theta;
    const double length = std::hypot(radius * theta, r2.z() - r1.z());
    const int segments = std::max(1, static_cast<int>(length / 0.002));
    if (only_wrap_of_path || segments < 2 || iteration >= 100) return length;
    const Vector3d u = radial(r1) / radius;
    const Vector3d turn = u.cross(radial(r2) / radius).normalized();
    const Vector3d v = turn.cross(u);
    const double sense = choice.long_wrap ? -1.0 : 1.0;
    const auto spiral = [&](double t) -> Vector3d {
      const double angle = sense * t * theta;
      return Vector3d(0.0, 0.0, r1.z() + t * (r2.z() - r1.z())) + radius * (std::cos(angle) * u + std::sin(angle) * v);
    };
    const double t = 1.0 / segments;
    const Vector3d w1 = spiral(t);
    const Vector3d w2 = spiral(1.0 - t);
    const bool moved1 = shift_tangent_point(p, r1, w1);
    const bool moved2 = shift_tangent_point(q, r2, w2);
    if (!moved1 && !moved2) return length;
  }
}

}  // namespace

OpenSimWrap wrap_cylinder_as_opensim(const WrapObject& object, bool only_wrap_of_path, const Vector3d& p,
                                     const Vector3d& q) {
  OpenSimWrap wrap;
  const double radius = object.dimensions[0];
  const double half_length = 0.5 * object.dimensions[1];
  const int side = object.quadrant.sign;
  const int axis = object.quadrant.axis;
  const Vector3d p_radial = radial(p);
  const Vector3d q_radial = radial(q);
  if (p_radial.squaredNorm() < radius * radius || q_radial.squaredNorm() < radius * radius) {
    wrap.action = OpenSimWrapAction::kInside;
    return wrap;
  }
  // Nearest point of the infinite line p-q to the axis.
  const Vector3d across = q_radial - p_radial;
  const double t_near = -p_radial.dot(across) / across.squaredNorm();
  const Vector3d near = p + t_near * (q - p);
  const bool meets = radial(near).squaredNorm() < radius * radius && t_near > 0.0 && t_near < 1.0;
  wrap.action = meets ? OpenSimWrapAction::kMandatory : OpenSimWrapAction::kNone;
  if (side != 0) {
    const double s = side;
    const bool p_active = sign_of(p[axis]) == s, q_active = sign_of(q[axis]) == s;
    const bool crosses = sign_of(p[axis]) != sign_of(q[axis]) && sign_of(near[axis]) != s;
    if ((!p_active && !q_active) || (!meets && crosses)) wrap.action = OpenSimWrapAction::kWrapped;
  }
  if (wrap.action == OpenSimWrapAction::kNone) return wrap;
  const TangentPair at_p = tangents(radius, p), at_q = tangents(radius, q);
  TangentChoice choice = side != 0 ? tangents_on_side(object.quadrant, p, q, at_p, at_q) : nearest_tangents(at_p, at_q);
  slide_into_plane(radius, p, q, choice);
  if (std::abs(choice.r1.z()) > half_length && std::abs(choice.r2.z()) > half_length) {
    wrap.action = OpenSimWrapAction::kNone;
    return wrap;
  }
  wrap.surface_length = spiral_length(radius, only_wrap_of_path, p, q, choice);
  wrap.r1 = choice.r1;
  wrap.r2 = choice.r2;
  return wrap;
}

}  // namespace veridyn::muscle::internal
