#pragma once

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/wrap_end.hpp"
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

/// Both ends outside `radius`, which is below the cylinder's own where an end was lifted.
template <typename Scalar>
Beyond<Scalar> wrap_outside(const WrapCylinder& cylinder, const CylinderPass& pass, const Scalar& radius,
                            const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& q,
                            WrapResult<Scalar>& result) {
  using std::atan2;
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  result.clear();
  result.meets = pass.meets;
  const Scalar none(0.0);
  if (!pass.long_way && !pass.meets) return {};
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
  result.status = WrapStatus::kWrapped;
  const Scalar flat = planar * per_length;
  const Scalar steep = dz * per_length;
  result.surface_length = arc / flat;
  const Scalar s1 = flat / d1, s2 = flat / d2;
  result.direction1 = Vector3((result.r1.x() - p.x()) * s1, (result.r1.y() - p.y()) * s1, steep);
  result.direction2 = Vector3((q.x() - result.r2.x()) * s2, (q.y() - result.r2.y()) * s2, steep);
  result.gradient_p = -result.direction1;
  result.gradient_q = result.direction2;
  if (!may_be_beyond(cylinder.radius, cylinder.half_length, value_of(p.z()), value_of(q.z()))) return {};
  const Vector3 first(result.direction1.x() / flat, result.direction1.y() / flat, none);
  const Vector3 last(result.direction2.x() / flat, result.direction2.y() / flat, none);
  return how_far_beyond<Scalar>(cylinder.radius, cylinder.half_length, radius, p, q, {planar, first, last, angle});
}

/// An end inside: that of its foot. Where nothing but the foot is touched, the path from there is straight.
template <typename Scalar>
void wrap_lifted_onto(const WrapCylinder& cylinder, const Lift<Scalar>& lift, bool radial, WrapResult<Scalar>& result) {
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  result.clear();
  const Vector3 &p = lift.p.foot, &q = lift.q.foot;
  if (!(value_of(lift.scale) > kLeastScale)) return;
  const Scalar radius = lift.scale * Scalar(cylinder.radius);
  WrapCylinder shrunk = cylinder;
  shrunk.radius = value_of(radius);
  const CylinderPass pass = cylinder_pass(shrunk, value_of(p.x()), value_of(p.y()), value_of(q.x()), value_of(q.y()));
  Beyond<Scalar> beyond = wrap_outside<Scalar>(cylinder, pass, radius, p, q, result);
  if (!result.wrapped() && may_be_beyond(cylinder.radius, cylinder.half_length, value_of(p.z()), value_of(q.z()))) {
    const Vector3 across(q.x() - p.x(), q.y() - p.y(), Scalar(0.0));
    const Scalar planar = sqrt(across.squaredNorm() + Scalar(1e-24));
    const Vector3 along = across / planar;
    beyond = how_far_beyond<Scalar>(cylinder.radius, cylinder.half_length, radius, p, q,
                                    {planar, along, along, Scalar(0.0)});
  }
  finish_lifted(lift, radial, result);
  if (!beyond.any()) return;
  pull_back<Scalar>(lift, false, beyond.by_radius * Scalar(cylinder.radius), beyond.by_p, beyond.by_q);
  let_go<Scalar>(cylinder.radius, lift.p.at, lift.q.at, beyond, result);
}

template <typename Scalar>
void wrap_onto(const WrapCylinder& cylinder, const Eigen::Matrix<Scalar, 3, 1>& p, const Eigen::Matrix<Scalar, 3, 1>& q,
               bool radial, WrapResult<Scalar>& result) {
  const CylinderPass pass = cylinder_pass(cylinder, value_of(p.x()), value_of(p.y()), value_of(q.x()), value_of(q.y()));
  if (std::min(pass.p2, pass.q2) * kOutwards < cylinder.radius * cylinder.radius) {
    const double w = 1.0 / (cylinder.radius * cylinder.radius);
    return wrap_lifted_onto(cylinder, lift_ends<Scalar>(Eigen::Vector3d(w, w, 0.0), p, q), radial, result);
  }
  const Beyond<Scalar> beyond = wrap_outside<Scalar>(cylinder, pass, Scalar(cylinder.radius), p, q, result);
  if (beyond.any()) let_go<Scalar>(cylinder.radius, p, q, beyond, result);
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
/// inactive side and the segment misses the cylinder, which OpenSim wraps and a string would not. Beyond the cylinder's
/// ends the path lets go (`wrap_end.hpp`).
template <typename Scalar>
[[nodiscard]] WrapResult<Scalar> wrap(const WrapCylinder& cylinder, const Eigen::Matrix<Scalar, 3, 1>& p,
                                      const Eigen::Matrix<Scalar, 3, 1>& q) {
  WrapResult<Scalar> result;
  internal::wrap_onto(cylinder, p, q, true, result);
  return result;
}

}  // namespace veridyn::muscle
