#pragma once

#include <Eigen/Core>

#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/model/scalar.hpp"

/// What the four wrap primitives share.
///
/// Each wraps one straight segment P Q, in the object's frame. A wrapped length |P r1| + surface + |r2 Q| is
/// the length of a taut string: stationary in the tangent points, so that unit tension does exactly the work of its
/// change (dL/dP = -direction1, dL/dQ = direction2), and closed forms or Newton's method find it to rounding.
///
/// An end inside an object is lifted to its surface (`wrap_lift.hpp`). A path that comes off the end of a cylinder lets
/// go of it over a way beyond that end (`wrap_end.hpp`), where OpenSim's jumps.
namespace veridyn::muscle {

/// How a segment goes past an object.
enum class WrapStatus {
  kStraight,  ///< the segment misses the object, or passes it on a side where it does not wrap
  kWrapped,
  kInside,  ///< as OpenSim only: an end lies inside the object, and the segment is left straight
  kFailed,  ///< the geodesic iteration did not converge: the segment is left straight
};

/// One segment wrapped over one object.
template <typename Scalar>
struct WrapResult {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;

  WrapStatus status = WrapStatus::kStraight;
  Vector3 r1 = Vector3::Zero();          ///< where the path reaches the object [m]
  Vector3 r2 = Vector3::Zero();          ///< where it leaves it [m]
  Scalar length{};                       ///< |P r1| + surface + |r2 Q| [m]
  Scalar surface_length{};               ///< [m]
  Vector3 direction1 = Vector3::Zero();  ///< unit, from P to r1
  Vector3 direction2 = Vector3::Zero();  ///< unit, from r2 to Q
  /// dL/dP and dL/dQ: -direction1 and direction2 unless an end was lifted.
  Vector3 gradient_p = Vector3::Zero();
  Vector3 gradient_q = Vector3::Zero();
  /// How much of the wrap counts, 0..1: below 1 where the path lets go of a cylinder; its derivatives with respect to
  /// P, Q.
  Scalar weight{1.0};
  Vector3 weight_p = Vector3::Zero();
  Vector3 weight_q = Vector3::Zero();
  /// How deep an end lies inside, in radii; 0 outside. Above 0, `surface_length` is what is missing from the straight
  /// parts to `length`.
  double depth = 0.0;
  /// The straight segment itself meets the object; false: only the wall of a quadrant makes it go round.
  bool meets = true;
  /// How far neighbouring paths from P have spread at Q, per length: 1 on flat and once curved surfaces; small where
  /// the surface focuses them and another path may be as short.
  double spread = 1.0;

  [[nodiscard]] bool wrapped() const { return status == WrapStatus::kWrapped; }

  /// Straight, without touching what only a wrap sets: most segments miss most objects.
  void clear() {
    status = WrapStatus::kStraight;
    weight = Scalar(1.0);
    depth = 0.0;
    meets = true;
    spread = 1.0;
  }
};

/// The value part of a vector: decisions are taken in double, derivatives follow.
template <typename Scalar>
[[nodiscard]] Eigen::Vector3d values_of(const Eigen::Matrix<Scalar, 3, 1>& v) {
  return {value_of(v.x()), value_of(v.y()), value_of(v.z())};
}

namespace internal {

/// Keeps an end off the surface by this part of the radius, where tangent points and derivatives are still well
/// conditioned.
inline constexpr double kSurfaceGap = 1e-6;

}  // namespace internal
}  // namespace veridyn::muscle
