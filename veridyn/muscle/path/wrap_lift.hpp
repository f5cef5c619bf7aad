#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "veridyn/muscle/path/wrap_result.hpp"

/// An end of a segment that lies inside its wrap object.
///
/// A taut string cannot start there. The end is lifted onto a surface from which it can, and the object shrinks with
/// it, so that the length has a continuous slope where an end dips in, and comes to the straight line's at the object's
/// centre. For x'Wx < 1 inside, with rho = sqrt(x'Wx) of both ends and g(rho) = rho (2 - rho), g = 1 outside:
///
///     G = g(rho_P) g(rho_Q)                              the object's scale
///     F = x + lambda N,  N = Wx/|Wx|,  F'WF = G^2         the foot of an end with rho < G
///     L(P, Q) = L_G(F_P, F_Q) + lambda_P s_P + lambda_Q s_Q
///     s_P = (c + sqrt(c^2 + eta^2))/2,  c = N_P (F_Q - F_P)/|F_Q - F_P|,  eta = 1 - rho_P/G
///
/// A string that leaves the surface at an angle to the normal of cosine c > 0 shortens by c for each metre that its end
/// rises, one that runs along the surface (c < 0) does not: so does the radial piece lambda s as lambda goes to zero,
/// and for lambda > 0 it is smooth between the two. L is continuous with its slope in both ends but at the centre (on
/// the axis of a cylinder), where its slope is bounded.
///
/// Between objects that share a segment the radial pieces are left out (`radial` false): they depend on where the
/// string goes, so that the next object's tangent points would not be stationary. There the slope jumps by at most c
/// where an end comes to the surface.
namespace veridyn::muscle::internal {

/// One end, where it was lifted to.
template <typename Scalar>
struct LiftedEnd {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  Vector3 at = Vector3::Zero();      ///< the end
  Vector3 foot = Vector3::Zero();    ///< `at` unless lifted
  Vector3 normal = Vector3::Zero();  ///< of the surface through the end
  Scalar rho{1.0};                   ///< of the end; 1 outside
  Scalar steepness{};                ///< |W at|
  Scalar height{};                   ///< lambda
  bool lifted = false;
};

/// What a segment's ends become for an object with x'Wx = 1 on its surface; `inverse_square` is the diagonal of W.
template <typename Scalar>
struct Lift {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  Eigen::Vector3d inverse_square = Eigen::Vector3d::Zero();
  LiftedEnd<Scalar> p, q;
  Scalar scale{1.0};
  /// The radial pieces and what they need for their slopes.
  Scalar radial{};
  Vector3 along = Vector3::Zero();  ///< unit, from foot to foot
  Scalar distance{};                ///< of the feet

  [[nodiscard]] bool any() const { return p.lifted || q.lifted; }
};

/// Ends nearer to the surface than this part of the size count as on it: tangent points stay well conditioned.
inline constexpr double kOutwards = (1.0 - kSurfaceGap) * (1.0 - kSurfaceGap);

/// Of an object so small that it is no obstacle.
inline constexpr double kLeastScale = 1e-6;

template <typename Scalar>
Scalar lift_scale(const Scalar& rho) {
  return rho * (Scalar(2.0) - rho);
}

template <typename Scalar>
void place_end(const Eigen::Vector3d& w, const Eigen::Matrix<Scalar, 3, 1>& x, LiftedEnd<Scalar>& end) {
  using std::sqrt;
  end.at = end.foot = x;
  end.height = Scalar(0.0);
  end.lifted = false;
  const Scalar rho2 = x.dot(x.cwiseProduct(w.cast<Scalar>())) * Scalar(kOutwards);
  end.rho = value_of(rho2) < 1.0 ? Scalar(sqrt(rho2 + Scalar(1e-18))) : Scalar(1.0);
}

template <typename Scalar>
void raise_end(const Eigen::Vector3d& w, const Scalar& scale, LiftedEnd<Scalar>& end) {
  using std::sqrt;
  if (!(value_of(end.rho) < value_of(scale))) return;
  const Eigen::Matrix<Scalar, 3, 1> ws = (w * kOutwards).cast<Scalar>();
  Eigen::Matrix<Scalar, 3, 1> steep = end.at.cwiseProduct(w.cast<Scalar>().eval());
  const Scalar n2 = steep.squaredNorm();
  if (!(value_of(n2) > 1e-16 * w.maxCoeff())) return;  // at the centre: any direction, of no length
  end.lifted = true;
  end.steepness = sqrt(n2);
  end.normal = steep / end.steepness;
  const Scalar a = end.normal.dot(end.normal.cwiseProduct(ws));
  const Scalar b = end.at.dot(end.normal.cwiseProduct(ws));
  const Scalar c = end.at.dot(end.at.cwiseProduct(ws)) - scale * scale;
  end.height = -c / (b + sqrt(b * b - a * c));
  end.foot = end.at + end.normal * end.height;
}

/// Whether an end lies inside.
template <typename Scalar>
bool dips_in(const Eigen::Vector3d& inverse_square, const Eigen::Matrix<Scalar, 3, 1>& p,
             const Eigen::Matrix<Scalar, 3, 1>& q) {
  const Eigen::Vector3d pv = values_of(p), qv = values_of(q);
  return pv.cwiseAbs2().dot(inverse_square) * kOutwards < 1.0 || qv.cwiseAbs2().dot(inverse_square) * kOutwards < 1.0;
}

/// Lifts the ends of a segment of which one or both lie inside.
template <typename Scalar>
Lift<Scalar> lift_ends(const Eigen::Vector3d& inverse_square, const Eigen::Matrix<Scalar, 3, 1>& p,
                       const Eigen::Matrix<Scalar, 3, 1>& q) {
  using std::sqrt;
  Lift<Scalar> lift;
  lift.inverse_square = inverse_square;
  place_end(inverse_square, p, lift.p);
  place_end(inverse_square, q, lift.q);
  lift.scale = lift_scale(lift.p.rho) * lift_scale(lift.q.rho);
  raise_end(inverse_square, lift.scale, lift.p);
  raise_end(inverse_square, lift.scale, lift.q);
  const Eigen::Matrix<Scalar, 3, 1> between = lift.q.foot - lift.p.foot;
  lift.distance = sqrt(between.squaredNorm() + Scalar(1e-24));
  lift.along = between / lift.distance;
  return lift;
}

/// s and its slopes for one end.
template <typename Scalar>
struct RadialPiece {
  Scalar factor{}, by_cosine{}, by_depth{};
};

template <typename Scalar>
RadialPiece<Scalar> radial_piece(const Scalar& cosine, const Scalar& depth) {
  using std::sqrt;
  const Scalar root = sqrt(cosine * cosine + depth * depth + Scalar(1e-24));
  return {(cosine + root) * Scalar(0.5), (Scalar(1.0) + cosine / root) * Scalar(0.5), depth / root * Scalar(0.5)};
}

/// Slopes with respect to feet and scale become slopes with respect to the ends: from_p, from_q hold dL/dF_P and
/// dL/dF_Q and are replaced by dL/dP and dL/dQ; `by_scale` is dL/dG. With `radial` the radial pieces are part of L:
/// their sum is returned.
template <typename Scalar>
Scalar pull_back(const Lift<Scalar>& lift, bool radial, Scalar by_scale, Eigen::Matrix<Scalar, 3, 1>& from_p,
                 Eigen::Matrix<Scalar, 3, 1>& from_q) {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  const Vector3 w = lift.inverse_square.template cast<Scalar>();
  const Vector3 ws = (lift.inverse_square * kOutwards).template cast<Scalar>();
  Vector3 normal_p = Vector3::Zero(), normal_q = Vector3::Zero();
  Scalar height_p(0.0), height_q(0.0), rho_p(0.0), rho_q(0.0), sum(0.0);
  const auto piece = [&](const LiftedEnd<Scalar>& end, const Vector3& along, Vector3& from_end, Vector3& from_other,
                         Vector3& normal, Scalar& height, Scalar& rho) {
    if (!end.lifted) return;
    const Scalar cosine = end.normal.dot(along);
    const RadialPiece<Scalar> s = radial_piece<Scalar>(cosine, Scalar(1.0) - end.rho / lift.scale);
    sum += end.height * s.factor;
    height += s.factor;
    const Scalar c = end.height * s.by_cosine;
    normal += along * c;
    const Vector3 turn = (end.normal - along * cosine) * (c / lift.distance);
    from_other += turn;
    from_end -= turn;
    const Scalar depth = end.height * s.by_depth / lift.scale;
    rho -= depth;
    by_scale += depth * end.rho / lift.scale;
  };
  if (radial) {
    piece(lift.p, lift.along, from_p, from_q, normal_p, height_p, rho_p);
    piece(lift.q, Vector3(-lift.along), from_q, from_p, normal_q, height_q, rho_q);
  }
  const auto foot = [&](const LiftedEnd<Scalar>& end, Vector3& from, Vector3& normal, Scalar& height) {
    if (!end.lifted) return;
    // F = x + lambda N, lambda from F'WF = G^2, N = Wx/|Wx|.
    height += from.dot(end.normal);
    normal += from * end.height;
    const Vector3 wf = end.foot.cwiseProduct(ws);
    const Scalar k = height / wf.dot(end.normal);
    by_scale += k * lift.scale;
    from -= wf * k;
    normal -= wf * (k * end.height);
    from += (normal - end.normal * end.normal.dot(normal)).cwiseProduct(w) / end.steepness;
  };
  foot(lift.p, from_p, normal_p, height_p);
  foot(lift.q, from_q, normal_q, height_q);
  const auto inside = [&](const LiftedEnd<Scalar>& end, const LiftedEnd<Scalar>& other, Scalar rho, Vector3& from) {
    if (!(value_of(end.rho) < 1.0)) return;
    rho += by_scale * lift_scale(other.rho) * (Scalar(2.0) - end.rho * Scalar(2.0));
    from += end.at.cwiseProduct(ws) * (rho / end.rho);
  };
  inside(lift.p, lift.q, rho_p, from_p);
  inside(lift.q, lift.p, rho_q, from_q);
  return sum;
}

/// The wrap of the lifted ends as one of the segment's: `result` holds that of the feet over the object of size
/// lift.scale, or none.
template <typename Scalar>
void finish_lifted(const Lift<Scalar>& lift, bool radial, WrapResult<Scalar>& result) {
  using std::sqrt;
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  if (!result.wrapped()) {
    result.r1 = lift.p.lifted ? lift.p.foot : lift.q.foot;
    result.r2 = lift.q.lifted ? lift.q.foot : lift.p.foot;
    result.length = lift.distance;
    result.gradient_p = -lift.along;
    result.gradient_q = lift.along;
    result.status = WrapStatus::kWrapped;
  }
  // L_G is homogeneous in the feet and the size.
  const Scalar growth =
      (result.length - lift.p.foot.dot(result.gradient_p) - lift.q.foot.dot(result.gradient_q)) / lift.scale;
  result.length += pull_back<Scalar>(lift, radial, growth, result.gradient_p, result.gradient_q);
  const auto straight = [](const Vector3& from, const Vector3& to, Vector3& direction) {
    const Vector3 way = to - from;
    const Scalar l2 = way.squaredNorm();
    if (!(value_of(l2) > 0.0)) {
      direction.setZero();
      return Scalar(0.0);
    }
    Scalar l = sqrt(l2);
    direction = way / l;
    return l;
  };
  const Scalar first = straight(lift.p.at, result.r1, result.direction1);
  const Scalar last = straight(result.r2, lift.q.at, result.direction2);
  result.surface_length = result.length - first - last;
  result.meets = true;
  result.depth = 1.0 - std::min(value_of(lift.p.rho), value_of(lift.q.rho));
}

/// Wraps the feet over an object that is homogeneous in its size by `outside(F_P, F_Q)`, which fills `result` for the
/// object at its own size.
template <typename Scalar, typename Outside>
void wrap_lifted(const Lift<Scalar>& lift, bool radial, WrapResult<Scalar>& result, const Outside& outside) {
  result.clear();
  if (!(value_of(lift.scale) > kLeastScale)) return;
  const Eigen::Matrix<Scalar, 3, 1> fp = lift.p.foot / lift.scale, fq = lift.q.foot / lift.scale;
  outside(fp, fq);
  result.r1 = result.r1 * lift.scale;
  result.r2 = result.r2 * lift.scale;
  result.length = result.length * lift.scale;
  finish_lifted(lift, radial, result);
}

}  // namespace veridyn::muscle::internal
