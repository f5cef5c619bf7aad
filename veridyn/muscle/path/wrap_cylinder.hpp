#pragma once

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/wrap_lift.hpp"
#include "veridyn/muscle/path/wrap_result.hpp"

namespace veridyn::muscle {

/// A circular cylinder about z, from -half_length to half_length [m].
struct WrapCylinder {
  double radius = 0.0;
  double half_length = 0.0;
  WrapQuadrant quadrant;
};

namespace internal {

/// How a segment passes a cylinder, from the ends' coordinates across its axis.
struct CylinderPass {
  bool meets = false;
  bool long_way = false;  ///< it crosses the quadrant's wall
  double cross = 0.0;
  double p2 = 0.0, q2 = 0.0;  ///< squared distances of the ends from the axis
};

inline CylinderPass cylinder_pass(const WrapCylinder& cylinder, double px, double py, double qx, double qy) {
  CylinderPass pass;
  const double ux = qx - px, uy = qy - py;
  pass.cross = px * qy - py * qx;
  pass.p2 = px * px + py * py;
  pass.q2 = qx * qx + qy * qy;
  if (cylinder.quadrant.sign != 0) {
    // Does the segment cross the wall { s x[axis] < 0, the other coordinate 0 }?
    const bool along_x = cylinder.quadrant.axis == 0;
    const double s = cylinder.quadrant.sign;
    const double side_p = along_x ? py : px;
    const double side_q = along_x ? qy : qx;
    if ((side_p < 0.0) != (side_q < 0.0)) {
      const double at = along_x ? px - ux * (py / uy) : py - uy * (px / ux);
      pass.long_way = s * at < 0.0 && cylinder.quadrant.axis != 2;
    }
  }
  const double u2 = ux * ux + uy * uy;
  const double along = -(px * ux + py * uy);
  pass.meets = along > 0.0 && along < u2 && pass.cross * pass.cross < cylinder.radius * cylinder.radius * u2;
  return pass;
}

/// A path over a cylinder as seen along the axis: straight parts of length d1 and d2 and the arc between them.
template <typename Scalar>
struct CylinderPath {
  Scalar radius;
  Scalar d1, d2;
  Scalar angle;   ///< of the arc
  Scalar planar;  ///< length of all three
  Scalar flat;    ///< planar / length
  Scalar slope;   ///< along the axis, per planar length
};

/// Lets a wrap go whose nearer tangent point lies beyond the cylinder's ends. Returns the weight's slope with respect
/// to the radius.
///
/// From the slopes of the tangent point's height, z1 = p.z + dz d1/planar or z2 = q.z - dz d2/planar. A planar taut
/// string's length changes by minus its direction at P, by its direction at Q, by its angle with the radius.
template <typename Scalar>
Scalar fade_beyond_ends(const WrapCylinder& cylinder, const Eigen::Matrix<Scalar, 3, 1>& p,
                        const Eigen::Matrix<Scalar, 3, 1>& q, const CylinderPath<Scalar>& path,
                        WrapResult<Scalar>& result) {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  const Scalar zero(0.0);
  const bool first = std::abs(value_of(result.r1.z())) < std::abs(value_of(result.r2.z()));
  const Scalar& height = first ? result.r1.z() : result.r2.z();
  const Vector3 in(result.direction1.x() / path.flat, result.direction1.y() / path.flat, zero);
  const Vector3 out(result.direction2.x() / path.flat, result.direction2.y() / path.flat, zero);
  const Scalar& d = first ? path.d1 : path.d2;
  const Scalar part = d / path.planar;
  const Vector3 d_slope = (first ? Vector3(p.x(), p.y(), zero) : Vector3(q.x(), q.y(), zero)) / d;
  // d part = (d d - part d planar) / planar
  Vector3 part_p = in * part, part_q = out * (-part);
  (first ? part_p : part_q) += d_slope;
  const Scalar part_radius = -path.radius / d - part * path.angle;
  const Scalar sign = first ? path.slope : Scalar(-path.slope);
  Vector3 height_p = part_p * sign, height_q = part_q * sign;
  height_p.z() += first ? Scalar(Scalar(1.0) - part) : part;
  height_q.z() += first ? part : Scalar(Scalar(1.0) - part);
  const double up = value_of(height) > 0.0 ? 1.0 : -1.0;
  const double band = (kEndFade - kEndStart) * cylinder.radius;
  const Scalar x = (height * Scalar(up) - Scalar(cylinder.half_length + kEndStart * cylinder.radius)) / Scalar(band);
  const Scalar change = fade_slope(x) * Scalar(up / band);
  result.weight = fade(x);
  result.weight_p = height_p * change;
  result.weight_q = height_q * change;
  return part_radius * sign * change;
}

/// Both ends outside `radius`, which is below the cylinder's own where an end was lifted. Returns the slope of the
/// weight with respect to it.
template <typename Scalar>
Scalar wrap_outside(const WrapCylinder& cylinder, const CylinderPass& pass, const Scalar& radius,
                    const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& q,
                    WrapResult<Scalar>& result) {
  using std::atan2;
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  result.clear();
  result.meets = pass.meets;
  const Scalar none(0.0);
  if (!pass.long_way && !pass.meets) return Scalar(0.0);
  const Scalar p2 = p.x() * p.x() + p.y() * p.y();
  const Scalar q2 = q.x() * q.x() + q.y() * q.y();
  const Scalar radius2 = radius * radius;
  const double turn = (pass.cross > 0.0) != pass.long_way ? 1.0 : -1.0;
  const Scalar d1 = sqrt(p2 - radius2);
  const Scalar d2 = sqrt(q2 - radius2);
  const Scalar ip = Scalar(1.0) / p2;
  const Scalar iq = Scalar(1.0) / q2;
  const Scalar ap = radius2 * ip, bp = radius * d1 * ip * Scalar(turn);
  const Scalar aq = radius2 * iq, bq = radius * d2 * iq * Scalar(turn);
  result.r1 = Vector3(p.x() * ap - p.y() * bp, p.y() * ap + p.x() * bp, none);
  result.r2 = Vector3(q.x() * aq + q.y() * bq, q.y() * aq - q.x() * bq, none);
  Scalar angle = atan2((result.r1.x() * result.r2.y() - result.r1.y() * result.r2.x()) * Scalar(turn),
                       result.r1.x() * result.r2.x() + result.r1.y() * result.r2.y());
  if (pass.long_way && angle < none) angle += Scalar(kFullTurn);
  const Scalar arc = radius * angle;
  const Scalar planar = d1 + arc + d2;
  const Scalar dz = q.z() - p.z();
  result.length = sqrt(planar * planar + dz * dz);
  const Scalar per_length = Scalar(1.0) / result.length;
  const Scalar slope = dz / planar;
  result.r1.z() = p.z() + slope * d1;
  result.r2.z() = q.z() - slope * d2;
  const double overrun =
      std::min(std::abs(value_of(result.r1.z())), std::abs(value_of(result.r2.z()))) - cylinder.half_length;
  if (overrun >= kEndFade * cylinder.radius) return Scalar(0.0);
  result.status = WrapStatus::kWrapped;
  const Scalar flat = planar * per_length;
  const Scalar steep = dz * per_length;
  result.surface_length = arc / flat;
  const Scalar s1 = flat / d1, s2 = flat / d2;
  result.direction1 = Vector3((result.r1.x() - p.x()) * s1, (result.r1.y() - p.y()) * s1, steep);
  result.direction2 = Vector3((q.x() - result.r2.x()) * s2, (q.y() - result.r2.y()) * s2, steep);
  result.gradient_p = -result.direction1;
  result.gradient_q = result.direction2;
  if (overrun > kEndStart * cylinder.radius)
    return fade_beyond_ends<Scalar>(cylinder, p, q, {radius, d1, d2, angle, planar, flat, slope}, result);
  return Scalar(0.0);
}

/// An end inside: that of its foot, with the ends' band as well where nothing but the foot is touched.
template <typename Scalar>
void wrap_lifted_onto(const WrapCylinder& cylinder, const Lift<Scalar>& lift, bool radial, WrapResult<Scalar>& result) {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  result.clear();
  const Vector3 &p = lift.p.foot, &q = lift.q.foot;
  if (!(value_of(lift.scale) > kLeastScale)) return;
  const Scalar radius = lift.scale * Scalar(cylinder.radius);
  WrapCylinder shrunk = cylinder;
  shrunk.radius = value_of(radius);
  const CylinderPass pass = cylinder_pass(shrunk, value_of(p.x()), value_of(p.y()), value_of(q.x()), value_of(q.y()));
  Scalar weight_radius = wrap_outside<Scalar>(cylinder, pass, radius, p, q, result);
  if (!pass.long_way && !pass.meets) {
    const bool first = lift.p.lifted && !(lift.q.lifted && std::abs(value_of(q.z())) < std::abs(value_of(p.z())));
    const Scalar& height = first ? p.z() : q.z();
    const double beyond = std::abs(value_of(height)) - cylinder.half_length;
    if (beyond >= kEndFade * cylinder.radius) return;
    if (beyond > kEndStart * cylinder.radius) {
      const double up = value_of(height) > 0.0 ? 1.0 : -1.0, band = (kEndFade - kEndStart) * cylinder.radius;
      const Scalar x =
          (height * Scalar(up) - Scalar(cylinder.half_length + kEndStart * cylinder.radius)) / Scalar(band);
      result.weight = fade(x);
      result.weight_p = result.weight_q = Vector3::Zero();
      (first ? result.weight_p : result.weight_q).z() = fade_slope(x) * Scalar(up / band);
    }
  } else if (!result.wrapped()) {
    return;  // beyond the ends
  }
  const bool fading = result.weight < Scalar(1.0);
  finish_lifted(lift, radial, result);
  if (fading) pull_back<Scalar>(lift, false, weight_radius * Scalar(cylinder.radius), result.weight_p, result.weight_q);
}

template <typename Scalar>
void wrap_onto(const WrapCylinder& cylinder, const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& q,
               bool radial, WrapResult<Scalar>& result) {
  const CylinderPass pass = cylinder_pass(cylinder, value_of(p.x()), value_of(p.y()), value_of(q.x()), value_of(q.y()));
  if (std::min(pass.p2, pass.q2) * kOutwards < cylinder.radius * cylinder.radius) {
    const double w = 1.0 / (cylinder.radius * cylinder.radius);
    return wrap_lifted_onto(cylinder, lift_ends<Scalar>(Eigen::Vector3d(w, w, 0.0), p, q), radial, result);
  }
  wrap_outside<Scalar>(cylinder, pass, Scalar(cylinder.radius), p, q, result);
}

// In muscle_path_evaluation.cpp.
extern template void wrap_onto<double>(const WrapCylinder&, const Eigen::Vector3d&, const Eigen::Vector3d&, bool,
                                       WrapResult<double>&);

}  // namespace internal

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
  WrapResult<Scalar> result;
  internal::wrap_onto(cylinder, p, q, true, result);
  return result;
}

}  // namespace veridyn::muscle
