#include "veridyn/muscle/path/wrap_opensim.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/wrap_opensim_parts.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;
using internal::angle_between;
using internal::sign_of;

// --- Ellipsoid ------------------------------------------------------------------------------------------------------

/// Foot of the perpendicular from `x` on the ellipsoid (ellipse, where `keep` names a coordinate that stays): the root
/// t of sum (a_i x_i / (t + a_i^2))^2 = 1 that lies right of all poles: the one of the nearest point.
Vector3d closest_point(const Vector3d& a, const Vector3d& x, int keep = -1) {
  if (keep < 0) {
    // A point on a plane of symmetry is treated as one of that plane's ellipse, of the smallest if there are several.
    double least = kInfinity;
    for (int i = 0; i < 3; ++i) {
      const double radii = a.sum() - a[i];
      if (std::abs(x[i]) <= 2e-13 && radii < least) {
        keep = i;
        least = radii;
      }
    }
  }
  double t = -kInfinity;
  for (int i = 0; i < 3; ++i)
    if (i != keep) t = std::max(t, a[i] * std::abs(x[i]) - a[i] * a[i]);
  for (int iteration = 0; iteration < 64; ++iteration) {
    double value = -1.0;
    double slope = 0.0;
    for (int i = 0; i < 3; ++i) {
      if (i == keep) continue;
      const double shifted = t + a[i] * a[i];
      const double w = a[i] * x[i] / shifted;
      if (!std::isfinite(w)) continue;
      value += w * w;
      slope -= 2.0 * w * w / shifted;
    }
    if (!(slope < 0.0)) break;
    const double step = value / slope;
    t -= step;
    if (std::abs(step) < 1e-14) break;
  }
  Vector3d foot = x;
  for (int i = 0; i < 3; ++i)
    if (i != keep) foot[i] = a[i] * a[i] * x[i] / (t + a[i] * a[i]);
  return foot;
}

struct Section {  // plane normal . x = offset
  Vector3d normal;
  double offset = 0.0;
};

/// Tangent point from `p` on the ellipse that `plane` cuts, on the side of the line p-q on which `near` lies.
Vector3d tangent_point(const Vector3d& a, const Section& plane, const Vector3d& p, const Vector3d& q,
                       const Vector3d& near) {
  // In coordinates x / a the ellipsoid is the unit sphere and the ellipse a circle.
  const Vector3d n_raw = plane.normal.cwiseProduct(a);
  const double scale = n_raw.norm();
  const Vector3d n = n_raw / scale;
  const Vector3d center = n * (plane.offset / scale);
  const double radius2 = std::max(0.0, 1.0 - center.squaredNorm());
  const Vector3d u = p.cwiseQuotient(a) - center;
  const double u2 = u.squaredNorm();
  const Vector3d along = u * (radius2 / u2);
  const Vector3d across = n.cross(u) * (std::sqrt(radius2 * std::max(0.0, u2 - radius2)) / u2);
  const Vector3d line = q.cwiseQuotient(a) - p.cwiseQuotient(a);
  const double side = n.cross(line).dot(near.cwiseQuotient(a) - p.cwiseQuotient(a));
  const double side_of_first = n.cross(line).dot(center + along + across - p.cwiseQuotient(a));
  const double side_of_second = n.cross(line).dot(center + along - across - p.cwiseQuotient(a));
  const bool first = side >= 0.0 ? side_of_first >= side_of_second : side_of_first < side_of_second;
  return (center + along + (first ? across : Vector3d(-across))).cwiseProduct(a);
}

struct SurfacePolygon {
  double length = 0.0;
  Vector3d second, last_but_one;
  int points = 0;
};

SurfacePolygon surface_polygon(const Vector3d& a, double factor, const Section& plane, const Vector3d& r1,
                               const Vector3d& r2, bool far_side) {
  SurfacePolygon polygon;
  const double chord = (r2 - r1).norm() / factor;
  if (chord < 0.001) {
    polygon.length = (r2 - r1).norm();
    polygon.points = 2;
    return polygon;
  }
  const int segments = std::min(499, static_cast<int>(chord / 0.001));
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(plane.normal[i]) > std::abs(plane.normal[axis])) axis = i;
  const Vector3d center = Vector3d::Unit(axis) * (plane.offset / plane.normal[axis]);
  const Vector3d e1 = (r1 - center).normalized();
  const Vector3d d2 = (r2 - center).normalized();
  const double angle = std::acos(std::clamp(e1.dot(d2), -1.0, 1.0));
  const double step = (far_side ? angle - kFullTurn : angle) / segments;
  const Vector3d e3 = e1.cross(d2).normalized();
  const Vector3d e2 = e3.cross(e1);
  Vector3d before = r1;
  for (int i = 1; i <= segments; ++i) {
    Vector3d point = r2;
    if (i < segments) {
      const Vector3d direction = std::cos(i * step) * e1 + std::sin(i * step) * e2;
      const Vector3d f1 = direction.cwiseQuotient(a);
      const Vector3d f2 = center.cwiseQuotient(a);
      const double aa = f1.squaredNorm();
      const double bb = f1.dot(f2);
      point = center + direction * ((-bb + std::sqrt(bb * bb - aa * (f2.squaredNorm() - 1.0))) / aa);
    }
    if (i == 1) polygon.second = point;
    if (i == segments - 1) polygon.last_but_one = point;
    polygon.length += (point - before).norm();
    before = point;
  }
  if (segments == 1) polygon.last_but_one = r1;
  polygon.points = segments + 1;
  return polygon;
}

/// Where the line p-q enters and leaves the ellipsoid, seen from q, if both happen between them.
struct Passage {
  Vector3d enter, leave;
};
std::optional<Passage> passage(const Vector3d& a, const Vector3d& p, const Vector3d& q) {
  const Vector3d qp = p - q;
  const Vector3d f1 = qp.cwiseQuotient(a);
  const Vector3d f2 = q.cwiseQuotient(a);
  const double aa = f1.squaredNorm();
  const double bb = f1.dot(f2);
  const double discriminant = bb * bb - aa * (f2.squaredNorm() - 1.0);
  if (discriminant < 0.0) return std::nullopt;
  const double l1 = (-bb + std::sqrt(discriminant)) / aa;
  const double l2 = (-bb - std::sqrt(discriminant)) / aa;
  if (!(0.0 < l1 && l1 < 1.0) || !(0.0 < l2 && l2 < 1.0)) return std::nullopt;
  return Passage{q + l1 * qp, q + l2 * qp};
}

/// A point of the surface that the wrapping plane goes through.
struct PlanePoint {
  Vector3d c = Vector3d::Zero();
  double axis_share = 0.0;  ///< of the axis that the segment follows most, 0 to 1
  double fan_weight = -kInfinity;
};
constexpr double kBlendLow = 0.7073;
constexpr double kBlendHigh = 0.9;

/// From the axis that the segment follows most ("axial"), from the middle of the chord ("midpoint"), or from that axis
/// blended with the mean direction of a fan ("hybrid").
PlanePoint plane_point(const Vector3d& a, EllipsoidMethod method, const Vector3d& along, const Vector3d& enter,
                       const Vector3d& chord) {
  constexpr double kEndBlend = 0.3;
  constexpr int kFan = 300;
  PlanePoint point;
  Vector3d mu = along.normalized().cwiseAbs();
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (mu[i] > mu[axis]) axis = i;
  const double t = -enter[axis] / chord[axis];
  if (method == EllipsoidMethod::kMidpoint) {
    point.c = closest_point(a, enter + 0.5 * chord);
    point.axis_share = mu[axis];
    return point;
  }
  if (method == EllipsoidMethod::kHybrid && mu[axis] > kBlendLow) {
    double s = 1.0;
    if (t < 0.0 || t > 1.0)
      s = 0.0;
    else if (t < kEndBlend)
      s = t / kEndBlend;
    else if (t > 1.0 - kEndBlend)
      s = (1.0 - t) / kEndBlend;
    mu[axis] = kBlendLow + s * (mu[axis] - kBlendLow);
  }
  if (method == EllipsoidMethod::kAxial || mu[axis] > kBlendLow) {
    Vector3d on_plane = enter + t * chord;
    on_plane[axis] = 0.0;
    point.c = closest_point(a, on_plane, axis);
  }
  if (method == EllipsoidMethod::kHybrid && mu[axis] < kBlendHigh) {
    Vector3d sum = Vector3d::Zero();
    for (int i = 1; i < kFan - 1; ++i) {
      const Vector3d at = enter + (static_cast<double>(i) / kFan) * chord;
      sum += (closest_point(a, at) - at).normalized();
    }
    const Vector3d fan = closest_point(a, enter + 0.5 * chord + sum.normalized());
    if (mu[axis] <= kBlendLow) {
      point.c = fan;
      point.fan_weight = 1.0;
    } else {
      const double weight = (mu[axis] - kBlendLow) / (kBlendHigh - kBlendLow);
      point.c = closest_point(a, weight * point.c + (1.0 - weight) * fan);
      point.fan_weight = 1.0 - weight;
    }
  }
  point.axis_share = mu[axis];
  return point;
}

OpenSimWrap wrap_ellipsoid(const WrapObject& object, EllipsoidMethod method, const Vector3d& p_object,
                           const Vector3d& q_object) {
  OpenSimWrap wrap;
  const double factor = 3.0 / object.dimensions.sum();
  const Vector3d a = object.dimensions * factor;
  const Vector3d p = p_object * factor;
  const Vector3d q = q_object * factor;
  if (p.cwiseQuotient(a).squaredNorm() < 0.9999 || q.cwiseQuotient(a).squaredNorm() < 0.9999) {
    wrap.action = OpenSimWrapAction::kInside;
    return wrap;
  }
  const Vector3d qp = p - q;
  if (std::abs(p.normalized().dot(q.normalized()) - 1.0) < 1e-4) return wrap;
  const std::optional<Passage> through = passage(a, p, q);
  if (!through) return wrap;
  auto [c, axis_share, fan_weight] = plane_point(a, method, qp, through->enter, through->leave - through->enter);
  Vector3d near = c;
  const int side = object.quadrant.sign;
  const int half = object.quadrant.axis;
  if (side != 0 && sign_of(c[half]) != side) {
    const double was = c[half];
    c[half] = -was;
    near = c;
    if (!std::isfinite(fan_weight)) fan_weight = 1.0 - (axis_share - kBlendLow) / (kBlendHigh - kBlendLow);
    fan_weight = std::min(fan_weight, 1.0);
    if (fan_weight > 0.0) {
      c[half] -= fan_weight * c[half];
      c = closest_point(a, c);
    }
  }
  Section plane;
  plane.normal = qp.cross(p - c).normalized();
  plane.offset = plane.normal.dot(c);
  const Vector3d r1 = tangent_point(a, plane, p, q, near);
  const Vector3d r2 = tangent_point(a, plane, q, p, near);
  SurfacePolygon polygon = surface_polygon(a, factor, plane, r1, r2, false);
  if (side != 0 && polygon.points > 2 &&
      ((p - r1).dot(polygon.second - r1) > 0.0 || (q - r2).dot(polygon.last_but_one - r2) > 0.0))
    polygon = surface_polygon(a, factor, plane, r1, r2, true);
  wrap.action = OpenSimWrapAction::kMandatory;
  wrap.r1 = r1 / factor;
  wrap.r2 = r2 / factor;
  wrap.surface_length = polygon.length / factor;
  return wrap;
}

// --- Sphere, torus --------------------------------------------------------------------------------------------------

OpenSimWrap wrap_sphere(const WrapObject& object, const Vector3d& p, const Vector3d& q) {
  OpenSimWrap wrap;
  const double radius = object.dimensions[0];
  const int side = object.quadrant.sign;
  const int axis = object.quadrant.axis;
  if (p.norm() < radius || q.norm() < radius) {
    wrap.action = OpenSimWrapAction::kInside;
    return wrap;
  }
  const Vector3d pq = q - p;
  const double t = -p.dot(pq) / pq.squaredNorm();
  const Vector3d near = p + t * pq;
  const double half_chord2 = radius * radius - near.squaredNorm();
  if (half_chord2 < 0.0) return wrap;
  const double reach = std::sqrt(half_chord2) / pq.norm();
  if (!(t - reach > 0.0 && t + reach < 1.0)) return wrap;
  wrap.action = OpenSimWrapAction::kWrapped;
  const Vector3d n = p.cross(q).normalized();
  if (!n.allFinite() || p.cross(q).norm() / (p.norm() * q.norm()) < 1e-12) {
    wrap.action = OpenSimWrapAction::kNone;
    return wrap;
  }
  const auto tangents = [&](const Vector3d& x, Vector3d& first, Vector3d& second) {
    const double distance2 = x.squaredNorm();
    const Vector3d along = x * (radius * radius / distance2);
    const Vector3d across = n.cross(x) * (radius * std::sqrt(distance2 - radius * radius) / distance2);
    first = along + across;
    second = along - across;
  };
  Vector3d r1a, r1b, r2a, r2b;
  tangents(p, r1a, r1b);
  tangents(q, r2a, r2b);
  // The near side: with n = p x q, from p forwards and from q backwards.
  Vector3d r1 = r1a, r2 = r2b;
  Vector3d other1 = r1b, other2 = r2a;
  bool far_side = false;
  if (side != 0) {
    const bool p_active = sign_of(p[axis]) == side;
    const bool q_active = sign_of(q[axis]) == side;
    if (p_active || q_active) wrap.action = OpenSimWrapAction::kMandatory;
    if (!p_active || !q_active) {
      const double active = side;
      if (active * ((r1 - p)[axis] + (r2 - q)[axis]) < 0.0) {
        std::swap(r1, other1);
        std::swap(r2, other2);
      }
      far_side = (r1 + r2).dot((r1 - p) + (r2 - q)) < 0.0;
    }
  }
  const double angle = angle_between(r1, r2);
  wrap.r1 = r1;
  wrap.r2 = r2;
  // Negative on what OpenSim calls the far side; its absolute value is the length.
  wrap.surface_length = radius * (far_side ? angle - kFullTurn : angle);
  return wrap;
}

}  // namespace

OpenSimWrap wrap_as_opensim(const WrapObject& object, EllipsoidMethod method, bool only_wrap_of_path, const Vector3d& p,
                            const Vector3d& q) {
  switch (object.shape) {
    case WrapShape::kSphere:
      return wrap_sphere(object, p, q);
    case WrapShape::kCylinder:
      return internal::wrap_cylinder_as_opensim(object, only_wrap_of_path, p, q);
    case WrapShape::kEllipsoid:
      return wrap_ellipsoid(object, method, p, q);
    case WrapShape::kTorus:
      break;
  }
  return {};
}

}  // namespace veridyn::muscle
