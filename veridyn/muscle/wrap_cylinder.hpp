#pragma once

#include <algorithm>
#include <cmath>

#include "veridyn/muscle/wrap_result.hpp"

namespace veridyn::muscle {

/// A circular cylinder about z, from -half_length to half_length [m].
struct WrapCylinder {
  double radius = 0.0;
  double half_length = 0.0;
  WrapQuadrant quadrant;
};

/// Shortest path over the cylinder: unrolled, straight part, helix and straight part are one straight line of length
/// sqrt(l^2 + dz^2), l the planar length of two tangents and an arc. Closed form, one arctangent.
///
/// Without a quadrant the path goes round the shorter way, where the segment meets the cylinder. A quadrant is read as
/// a wall from the axis to infinity on the inactive side: the path never crosses it, so it may go round the longer way
/// even where the segment does not meet the cylinder. That is OpenSim's choice except where both ends lie on the
/// inactive side and the segment misses the cylinder, which OpenSim wraps and a string would not. There is no wrap
/// where both tangent points lie beyond the cylinder's ends (plus the fade, `wrap_result.hpp`).
template <typename Scalar>
[[nodiscard]] WrapResult<Scalar> wrap(const WrapCylinder& cylinder, const Eigen::Matrix<Scalar, 3, 1>& p,
                                      const Eigen::Matrix<Scalar, 3, 1>& q) {
  using std::atan2;
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  WrapResult<Scalar> result;
  const double px = value_of(p.x()), py = value_of(p.y()), qx = value_of(q.x()), qy = value_of(q.y());
  const double ux = qx - px, uy = qy - py;
  const double cross = px * qy - py * qx;
  bool long_way = false;
  if (cylinder.quadrant.sign != 0) {
    // Does the segment cross the wall { s x[axis] < 0, the other coordinate 0 }?
    const bool along_x = cylinder.quadrant.axis == 0;
    const double s = cylinder.quadrant.sign;
    const double side_p = along_x ? py : px;
    const double side_q = along_x ? qy : qx;
    if ((side_p < 0.0) != (side_q < 0.0)) {
      const double at = along_x ? px - ux * (py / uy) : py - uy * (px / ux);
      long_way = s * at < 0.0 && cylinder.quadrant.axis != 2;
    }
  }
  const double u2 = ux * ux + uy * uy;
  const double along = -(px * ux + py * uy);
  result.meets = along > 0.0 && along < u2 && cross * cross < cylinder.radius * cylinder.radius * u2;
  if (!long_way && !result.meets) return result;

  const Scalar p2 = p.x() * p.x() + p.y() * p.y();
  const Scalar q2 = q.x() * q.x() + q.y() * q.y();
  const double gap = (1.0 - internal::kSurfaceGap) * (1.0 - internal::kSurfaceGap);
  Scalar radius2(cylinder.radius * cylinder.radius);
  const Scalar& nearer2 = p2 < q2 ? p2 : q2;
  const bool inside = value_of(nearer2) * gap < value_of(radius2);
  if (inside) radius2 = nearer2 * Scalar(gap);
  const Scalar radius = inside ? Scalar(sqrt(radius2)) : Scalar(cylinder.radius);
  if (inside) {
    result.depth = 1.0 - value_of(radius) / cylinder.radius;
    if (result.depth >= kInsideFade) {
      result.status = WrapStatus::kInside;
      return result;
    }
    result.weight = internal::fade(result.depth / kInsideFade);
  }
  const double turn = (cross > 0.0) != long_way ? 1.0 : -1.0;
  const Scalar d1 = sqrt(p2 - radius2);
  const Scalar d2 = sqrt(q2 - radius2);
  const Scalar ip = Scalar(1.0) / p2;
  const Scalar iq = Scalar(1.0) / q2;
  const Scalar ap = radius2 * ip, bp = radius * d1 * ip * Scalar(turn);
  const Scalar aq = radius2 * iq, bq = radius * d2 * iq * Scalar(turn);
  result.r1 = Vector3(p.x() * ap - p.y() * bp, p.y() * ap + p.x() * bp, Scalar(0.0));
  result.r2 = Vector3(q.x() * aq + q.y() * bq, q.y() * aq - q.x() * bq, Scalar(0.0));
  Scalar angle = atan2((result.r1.x() * result.r2.y() - result.r1.y() * result.r2.x()) * Scalar(turn),
                       result.r1.x() * result.r2.x() + result.r1.y() * result.r2.y());
  if (long_way && angle < Scalar(0.0)) angle += Scalar(6.283185307179586);
  const Scalar arc = radius * angle;
  const Scalar planar = d1 + arc + d2;
  const Scalar dz = q.z() - p.z();
  result.length = sqrt(planar * planar + dz * dz);
  const Scalar per_length = Scalar(1.0) / result.length;
  const Scalar slope = dz / planar;
  result.r1.z() = p.z() + slope * d1;
  result.r2.z() = q.z() - slope * d2;
  const double overrun = std::min(std::abs(value_of(result.r1.z())), std::abs(value_of(result.r2.z()))) -
                         cylinder.half_length;
  if (overrun > kEndStart * cylinder.radius) {
    if (overrun >= kEndFade * cylinder.radius) return result;
    result.weight *= internal::fade((overrun / cylinder.radius - kEndStart) / (kEndFade - kEndStart));
  }
  result.status = WrapStatus::kWrapped;
  const Scalar flat = planar * per_length;
  const Scalar steep = dz * per_length;
  result.surface_length = arc / flat;
  const Scalar s1 = flat / d1, s2 = flat / d2;
  result.direction1 = Vector3((result.r1.x() - p.x()) * s1, (result.r1.y() - p.y()) * s1, steep);
  result.direction2 = Vector3((q.x() - result.r2.x()) * s2, (q.y() - result.r2.y()) * s2, steep);
  result.gradient_p = -result.direction1;
  result.gradient_q = result.direction2;
  if (inside) {
    // dL/dradius = angle planar/L, and the radius follows the end that lies inside.
    const Scalar pull = angle * flat * Scalar(gap) / radius;
    if (p2 < q2) {
      result.gradient_p.x() += pull * p.x();
      result.gradient_p.y() += pull * p.y();
    } else {
      result.gradient_q.x() += pull * q.x();
      result.gradient_q.y() += pull * q.y();
    }
  }
  return result;
}

/// Weight of a wrap as a function of its ends, to be differentiated; equals `wrap(...).weight`.
template <typename Scalar>
[[nodiscard]] Scalar wrap_weight(const WrapCylinder& cylinder, const Eigen::Matrix<Scalar, 3, 1>& p,
                                 const Eigen::Matrix<Scalar, 3, 1>& q) {
  using std::abs;
  using std::sqrt;
  const WrapResult<Scalar> path = wrap(cylinder, p, q);
  if (!path.wrapped()) return Scalar(0.0);
  Scalar weight(1.0);
  if (path.depth > 0.0) {
    const Scalar p2 = p.x() * p.x() + p.y() * p.y();
    const Scalar q2 = q.x() * q.x() + q.y() * q.y();
    const Scalar depth =
        Scalar(1.0) - sqrt(p2 < q2 ? p2 : q2) * Scalar((1.0 - internal::kSurfaceGap) / cylinder.radius);
    weight = internal::fade(Scalar(depth / Scalar(kInsideFade)));
  }
  const Scalar z1 = abs(path.r1.z()), z2 = abs(path.r2.z());
  const Scalar overrun = (z1 < z2 ? z1 : z2) - Scalar(cylinder.half_length);
  return weight *
         internal::fade(Scalar((overrun / Scalar(cylinder.radius) - Scalar(kEndStart)) / Scalar(kEndFade - kEndStart)));
}

}  // namespace veridyn::muscle
