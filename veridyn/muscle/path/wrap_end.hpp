#pragma once

#include <algorithm>
#include <cmath>

#include "veridyn/muscle/path/wrap_result.hpp"

/// How a path comes off the end of a cylinder.
///
/// OpenSim drops a wrap whose tangent points both lie beyond the same or opposite ends, and the length jumps by the
/// whole detour e = L_with - L_without. Here the wrap counts less and less as the path gets further beyond the end, by
/// o metres:
///
///     L = L_without + w (L_with - L_without),  w = fade(o/b),  b = sqrt(b0^2 + (1.5 e/s)^2)
///
/// fade falls from 1 to 0 with a slope of at most 1.5. A short detour goes within b0, a long one over a longer way, so
/// that a path that moves off by a metre gets shorter by at most s = kSteepest metres and arms stay within a small
/// multiple of the levers that the path has. (Half of it would be a string's own measure, but arm26's long head of the
/// triceps would then be as OpenSim's below 23 deg of the shoulder only, instead of below 29 deg.) Of several objects
/// on a segment each goes by its own detour e there.
namespace veridyn::muscle::internal {

inline constexpr double kEndStart = 0.1;  ///< o = 0 this far beyond the end [radii of the cylinder]
inline constexpr double kEndBand = 0.5;   ///< b0 [radii of the cylinder]
inline constexpr double kSteepest = 2.0;  ///< [m/m]

/// 1 at x <= 0, 0 at x >= 1, slope zero at both.
template <typename Scalar>
[[nodiscard]] Scalar fade(const Scalar& x) {
  if (!(x > Scalar(0.0))) return Scalar(1.0);
  if (!(x < Scalar(1.0))) return Scalar(0.0);
  return Scalar(1.0) - x * x * (Scalar(3.0) - Scalar(2.0) * x);
}
template <typename Scalar>
[[nodiscard]] Scalar fade_slope(const Scalar& x) {
  if (!(x > Scalar(0.0)) || !(x < Scalar(1.0))) return Scalar(0.0);
  return Scalar(-6.0) * x * (Scalar(1.0) - x);
}

/// How much of a wrap counts.
template <typename Scalar>
struct LettingGo {
  Scalar part{};       ///< w
  Scalar by_detour{};  ///< its slope with e
  Scalar by_beyond{};  ///< and with o
};

template <typename Scalar>
[[nodiscard]] LettingGo<Scalar> letting_go(const Scalar& detour, const Scalar& beyond, double least_band) {
  using std::sqrt;
  const Scalar stretch = detour * Scalar(1.5 / kSteepest);
  const Scalar band = sqrt(stretch * stretch + Scalar(least_band * least_band));
  const Scalar x = beyond / band;
  const Scalar slope = fade_slope(x) / band;
  return {fade(x), -slope * x * stretch * Scalar(1.5 / kSteepest) / band, slope};
}

/// How far a path is beyond a cylinder's ends [m], 0: not at all; with its slopes.
template <typename Scalar>
struct Beyond {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  Scalar by{0.0};
  Vector3 by_p = Vector3::Zero(), by_q = Vector3::Zero();
  Scalar by_radius{0.0};

  [[nodiscard]] bool any() const { return by > Scalar(0.0); }
};

/// A path past a cylinder as seen along the axis, with slopes with respect to its ends and the radius.
template <typename Scalar>
struct PlanarPath {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  Scalar length;        ///< of the straight parts and the arc between them
  Vector3 first, last;  ///< unit, of the straight parts: the length changes by -first dP + last dQ
  Scalar angle;         ///< of the arc: the length's slope with the radius
};

/// How far a path is beyond the ends.
///
/// Of the heights z1, z2 of the tangent points the one nearer to the middle counts, rounded where they are equal. With
/// d1, d2 the lengths of the tangents, l that of the planar path and c = 0.2 of the radius
///
///     z1 = p.z + (q.z - p.z) sqrt(d1^2 + c^2)/(l + 2c),  z2 = q.z - (q.z - p.z) sqrt(d2^2 + c^2)/(l + 2c),
///
/// the tangent points' own for c = 0; c keeps slopes bounded where an end comes to the surface.
template <typename Scalar>
[[nodiscard]] Beyond<Scalar> how_far_beyond(double cylinder_radius, double half_length, const Scalar& radius,
                                            const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& q,
                                            const PlanarPath<Scalar>& path) {
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  const double start = half_length + kEndStart * cylinder_radius, c = 0.2 * cylinder_radius;
  const Scalar one(1.0), zero(0.0), half(0.5);
  const Scalar rounding = Scalar(c * c) - radius * radius;
  const Scalar e1 = sqrt(p.x() * p.x() + p.y() * p.y() + rounding);
  const Scalar e2 = sqrt(q.x() * q.x() + q.y() * q.y() + rounding);
  const Scalar per = one / (path.length + Scalar(2.0 * c));
  const Scalar rise = (q.z() - p.z()) * per;
  const Scalar z1 = p.z() + rise * e1, z2 = q.z() - rise * e2;
  const double s1 = value_of(z1) > 0.0 ? 1.0 : -1.0, s2 = value_of(z2) > 0.0 ? 1.0 : -1.0;
  const Scalar apart = z1 * Scalar(s1) - z2 * Scalar(s2);
  const Scalar root = sqrt(apart * apart + Scalar(0.25 * c * c));
  Beyond<Scalar> beyond;
  beyond.by = (z1 * Scalar(s1) + z2 * Scalar(s2) - root) * half - Scalar(start);
  if (!(value_of(beyond.by) > 0.0)) return {};
  const Vector3 up(zero, zero, one);
  const Vector3 rise_p = (path.first * rise - up) * per, rise_q = (up - path.last * rise) * per;
  const Scalar rise_radius = -rise * path.angle * per;
  const Scalar by_1 = (one - apart / root) * half * Scalar(s1), by_2 = (one + apart / root) * half * Scalar(s2);
  const Vector3 across_p(p.x(), p.y(), zero), across_q(q.x(), q.y(), zero);
  beyond.by_p = (up + rise_p * e1 + across_p * (rise / e1)) * by_1 - rise_p * (e2 * by_2);
  beyond.by_q = rise_q * (e1 * by_1) + (up - rise_q * e2 - across_q * (rise / e2)) * by_2;
  beyond.by_radius = (rise_radius * e1 - rise * radius / e1) * by_1 - (rise_radius * e2 - rise * radius / e2) * by_2;
  return beyond;
}

/// Lets the wrap in `result` go by as much as its path from p to q is beyond the ends.
template <typename Scalar>
void let_go(double cylinder_radius, const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& q,
            const Beyond<Scalar>& beyond, WrapResult<Scalar>& result) {
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  const Vector3 between = q - p;
  const Scalar straight = sqrt(between.squaredNorm() + Scalar(1e-24));
  const Vector3 along = between / straight;
  const LettingGo<Scalar> left = letting_go<Scalar>(result.length - straight, beyond.by, kEndBand * cylinder_radius);
  if (!(left.part > Scalar(0.0))) {
    result.status = WrapStatus::kStraight;
    return;
  }
  result.weight = left.part;
  result.weight_p = beyond.by_p * left.by_beyond + (result.gradient_p + along) * left.by_detour;
  result.weight_q = beyond.by_q * left.by_beyond + (result.gradient_q - along) * left.by_detour;
}

/// Whether ends at these heights can belong to a path beyond the cylinder's ends.
inline bool may_be_beyond(double cylinder_radius, double half_length, double z1, double z2) {
  return std::max(std::abs(z1), std::abs(z2)) > half_length + kEndStart * cylinder_radius;
}

}  // namespace veridyn::muscle::internal
