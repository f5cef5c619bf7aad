#include "veridyn/muscle/path/wrap_opensim.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

double sign_of(double x) { return x >= 0.0 ? 1.0 : -1.0; }
double angle_between(const Vector3d& u, const Vector3d& v) {
  return std::acos(std::clamp(u.dot(v) / (u.norm() * v.norm()), -1.0, 1.0));
}

// --- Ellipsoid ------------------------------------------------------------------------------------------------------

/// Foot of the perpendicular from `x` on the ellipsoid (ellipse, where `keep` names a coordinate that stays): the root
/// t of sum (a_i x_i / (t + a_i^2))^2 = 1 that lies right of all poles but the nearest point's own.
Vector3d closest_point(const Vector3d& a, const Vector3d& x, int keep = -1) {
  if (keep < 0) {
    // A point on a plane of symmetry is treated as one of that plane's ellipse, of the smallest if there are several.
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      const double radii = a.sum() - a[i];
      if (std::abs(x[i]) <= 2e-13 && radii < least) {
        keep = i;
        least = radii;
      }
    }
  }
  double t = -std::numeric_limits<double>::infinity();
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
  const double step = (far_side ? angle - 2.0 * kPi : angle) / segments;
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

OpenSimWrap wrap_ellipsoid(const WrapObject& object, EllipsoidMethod method, const Vector3d& p_object,
                           const Vector3d& q_object) {
  constexpr double kBlendLow = 0.7073;
  constexpr double kBlendHigh = 0.9;
  constexpr double kEndBlend = 0.3;
  constexpr int kFan = 300;
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
  const Vector3d f1 = qp.cwiseQuotient(a);
  const Vector3d f2 = q.cwiseQuotient(a);
  const double aa = f1.squaredNorm();
  const double bb = f1.dot(f2);
  const double discriminant = bb * bb - aa * (f2.squaredNorm() - 1.0);
  if (discriminant < 0.0) return wrap;
  const double l1 = (-bb + std::sqrt(discriminant)) / aa;
  const double l2 = (-bb - std::sqrt(discriminant)) / aa;
  if (!(0.0 < l1 && l1 < 1.0) || !(0.0 < l2 && l2 < 1.0)) return wrap;
  const Vector3d enter = q + l1 * qp;
  const Vector3d leave = q + l2 * qp;
  const Vector3d chord = leave - enter;

  // The plane contains p, q and a surface point `c`, from the axis that the segment follows most ("axial"), from the
  // middle of the chord ("midpoint"), or from that axis blended with the mean direction of a fan ("hybrid").
  Vector3d mu = qp.normalized().cwiseAbs();
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (mu[i] > mu[axis]) axis = i;
  const double t = -enter[axis] / chord[axis];
  Vector3d c = Vector3d::Zero();
  double fan_weight = -std::numeric_limits<double>::infinity();
  if (method == EllipsoidMethod::kMidpoint) {
    c = closest_point(a, enter + 0.5 * chord);
  } else {
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
      c = closest_point(a, on_plane, axis);
    }
    if (method == EllipsoidMethod::kHybrid && mu[axis] < kBlendHigh) {
      Vector3d sum = Vector3d::Zero();
      for (int i = 1; i < kFan - 1; ++i) {
        const Vector3d at = enter + (static_cast<double>(i) / kFan) * chord;
        sum += (closest_point(a, at) - at).normalized();
      }
      const Vector3d fan = closest_point(a, enter + 0.5 * chord + sum.normalized());
      if (mu[axis] <= kBlendLow) {
        c = fan;
        fan_weight = 1.0;
      } else {
        const double weight = (mu[axis] - kBlendLow) / (kBlendHigh - kBlendLow);
        c = closest_point(a, weight * c + (1.0 - weight) * fan);
        fan_weight = 1.0 - weight;
      }
    }
  }
  Vector3d near = c;
  const int side = object.quadrant.sign;
  const int half = object.quadrant.axis;
  if (side != 0 && sign_of(c[half]) != side) {
    const double was = c[half];
    c[half] = -was;
    near = c;
    if (!std::isfinite(fan_weight)) fan_weight = 1.0 - (mu[axis] - kBlendLow) / (kBlendHigh - kBlendLow);
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

// --- Cylinder -------------------------------------------------------------------------------------------------------

Vector3d radial(const Vector3d& x) { return {x.x(), x.y(), 0.0}; }

/// Moves `r` along the axis where the straight part and the spiral's first chord differ in slope by over 0.1 degree.
bool shift_tangent_point(const Vector3d& p, Vector3d& r, const Vector3d& w) {
  const Vector3d in = (r - p).normalized();
  const Vector3d on = (w - r).normalized();
  if (!(std::abs(std::acos(std::clamp(in.z(), -1.0, 1.0)) - std::acos(std::clamp(on.z(), -1.0, 1.0))) >
        0.1 * kPi / 180.0))
    return false;
  // Where the line p-w passes the line through the feet of p and w on the axis-parallel through r.
  // Both feet lie on one line parallel to the axis; the nearest points of p-w to it:
  const Vector3d u = w - p;
  const Vector3d across = radial(u);
  const double s = across.squaredNorm() > 0.0 ? -radial(p - r).dot(across) / across.squaredNorm() : 0.0;
  r.z() += 1.5 * (p.z() + s * u.z() - r.z());
  return true;
}

OpenSimWrap wrap_cylinder(const WrapObject& object, bool only_wrap_of_path, const Vector3d& p, const Vector3d& q) {
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
  wrap.action = OpenSimWrapAction::kWrapped;
  if (side == 0) {
    if (!meets) {
      wrap.action = OpenSimWrapAction::kNone;
      return wrap;
    }
    wrap.action = OpenSimWrapAction::kMandatory;
  }
  const Vector3d axis_p{0.0, 0.0, p.z()};
  const Vector3d axis_q{0.0, 0.0, q.z()};
  const double p_distance = p_radial.norm();
  const double q_distance = q_radial.norm();
  const auto tangents = [&](const Vector3d& radial_part, double distance, const Vector3d& foot, Vector3d& first,
                            Vector3d& second) {
    const Vector3d v = radial_part / distance;
    const double along = radius * radius / distance;
    const double beside = std::sqrt(std::max(0.0, radius * radius - along * along));
    const Vector3d u = Vector3d::UnitZ().cross(v);
    first = foot + along * v + beside * u;
    second = foot + along * v - beside * u;
  };
  Vector3d r1a, r1b, r2a, r2b;
  tangents(p_radial, p_distance, axis_p, r1a, r1b);
  tangents(q_radial, q_distance, axis_q, r2a, r2b);
  bool far_side = false;
  bool long_wrap = false;
  Vector3d r1, r2;
  if (side != 0) {
    const double s = side;
    if (sign_of(p[axis]) == s || sign_of(q[axis]) == s) {
      if (meets) {
        wrap.action = OpenSimWrapAction::kMandatory;
      } else if (!(sign_of(p[axis]) != sign_of(q[axis]) && sign_of(near[axis]) != s)) {
        wrap.action = OpenSimWrapAction::kNone;
        return wrap;
      }
    }
    const double alpha = angle_between(radial(r1a), radial(r2b));
    const double beta = angle_between(radial(r1b), radial(r2a));
    const bool a1 = sign_of(r1a[axis]) == s;
    const bool b1 = sign_of(r1b[axis]) == s;
    bool take_a = false;  // r1a with r2b; otherwise r1b with r2a
    bool none_active = false;
    if (a1 != b1) {
      take_a = a1;
    } else if (a1) {
      take_a = sign_of(r2a[axis]) != s;
    } else if (sign_of(r2a[axis]) == s) {
      take_a = false;
    } else if (sign_of(r2b[axis]) == s) {
      take_a = true;
    } else {
      take_a = alpha > beta;
      none_active = true;
    }
    r1 = take_a ? r1a : r1b;
    r2 = take_a ? r2b : r2a;
    far_side = none_active || (take_a == (alpha > beta));
    const Vector3d outward = (r1 - p) + (r2 - q);
    long_wrap = (radial(r1) + radial(r2)).dot(outward) < 0.0;
  } else {
    const std::array<double, 4> dots{radial(r1a).dot(radial(r2a)), radial(r1a).dot(radial(r2b)),
                                     radial(r1b).dot(radial(r2a)), radial(r1b).dot(radial(r2b))};
    const auto best = std::max_element(dots.begin(), dots.end()) - dots.begin();
    r1 = best < 2 ? r1a : r1b;
    r2 = best % 2 == 0 ? r2a : r2b;
  }
  // Slide both along the axis into the plane of p, q and an apex.
  const double t_apex = p_distance / (p_distance + q_distance);
  const Vector3d middle = p + t_apex * (q - p);
  const Vector3d foot{0.0, 0.0, middle.z()};
  const Vector3d normal = (p - foot).normalized().cross((q - foot).normalized()).normalized();
  const Vector3d apex1 = foot + radius * Vector3d::UnitZ().cross(normal).normalized();
  const Vector3d apex2 = foot - radius * Vector3d::UnitZ().cross(normal).normalized();
  const bool first_nearer = (middle - apex1).squaredNorm() < (middle - apex2).squaredNorm();
  const Vector3d apex = first_nearer != far_side ? apex1 : apex2;
  const Vector3d cut = (p - apex).normalized().cross((q - apex).normalized()).normalized();
  const double low = std::min(p.z(), q.z());
  const double high = std::max(p.z(), q.z());
  const auto slide = [&](Vector3d& r) {
    if (std::abs(20.0 * cut.z()) < 1e-5) return;
    const double z = r.z() - cut.dot(r - p) / cut.z();
    if (z > low && z < high) r.z() = z;
  };
  slide(r1);
  slide(r2);
  if (std::abs(r1.z()) > half_length && std::abs(r2.z()) > half_length) {
    wrap.action = OpenSimWrapAction::kNone;
    return wrap;
  }
  // Length of the spiral; tangent points are shifted along the axis unless this is the path's only wrap.
  for (int iteration = 0;; ++iteration) {
    double theta = angle_between(radial(r1), radial(r2));
    if (long_wrap) theta = 2.0 * kPi - theta;
    wrap.surface_length = std::hypot(radius * theta, r2.z() - r1.z());
    const int segments = std::max(1, static_cast<int>(wrap.surface_length / 0.002));
    if (only_wrap_of_path || segments < 2 || iteration >= 100) break;
    const Vector3d u = radial(r1) / radius;
    const Vector3d turn = u.cross(radial(r2) / radius).normalized();
    const Vector3d v = turn.cross(u);
    const double sense = long_wrap ? -1.0 : 1.0;
    const auto spiral = [&](double t) -> Vector3d {
      const double angle = sense * t * theta;
      return Vector3d(0.0, 0.0, r1.z() + t * (r2.z() - r1.z())) + radius * (std::cos(angle) * u + std::sin(angle) * v);
    };
    const double t = 1.0 / segments;
    const Vector3d w1 = spiral(t);
    const Vector3d w2 = spiral(1.0 - t);
    const bool moved1 = shift_tangent_point(p, r1, w1);
    const bool moved2 = shift_tangent_point(q, r2, w2);
    if (!moved1 && !moved2) break;
  }
  wrap.r1 = r1;
  wrap.r2 = r2;
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
    const Vector3d beside = n.cross(x) * (radius * std::sqrt(distance2 - radius * radius) / distance2);
    first = along + beside;
    second = along - beside;
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
  // OpenSim's own far side counts negative; its size is what a reader would expect.
  wrap.surface_length = radius * (far_side ? angle - 2.0 * kPi : angle);
  return wrap;
}

}  // namespace

OpenSimWrap wrap_as_opensim(const WrapObject& object, EllipsoidMethod method, bool only_wrap_of_path, const Vector3d& p,
                            const Vector3d& q) {
  switch (object.shape) {
    case WrapShape::kSphere:
      return wrap_sphere(object, p, q);
    case WrapShape::kCylinder:
      return wrap_cylinder(object, only_wrap_of_path, p, q);
    case WrapShape::kEllipsoid:
      return wrap_ellipsoid(object, method, p, q);
    case WrapShape::kTorus:
      break;
  }
  return {};
}

}  // namespace veridyn::muscle
