#pragma once

#include <Eigen/Core>

#include "veridyn/muscle/model.hpp"

namespace veridyn::muscle {

enum class WrapStatus {
  kStraight,  ///< the segment misses the object, or passes it on a side where it does not wrap
  kWrapped,
  kInside,  ///< an end lies inside the object: no wrap exists, the segment is left straight
  kFailed,  ///< the geodesic iteration did not converge: the segment is left straight
};

/// Shortest path from P to Q over one object, all vectors in the object's frame [m].
///
/// Its length |P r1| + surface_length + |r2 Q| is stationary in the tangent points, so its derivative with respect to
/// P is -direction1 and with respect to Q direction2: unit tension does exactly the work of the change of length.
template <typename Scalar>
struct WrapResult {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;

  WrapStatus status = WrapStatus::kStraight;
  Vector3 r1;             ///< where the path reaches the object
  Vector3 r2;             ///< where it leaves it
  Scalar length1{};       ///< |P r1|
  Scalar surface_length{};
  Scalar length2{};       ///< |r2 Q|
  Vector3 direction1;     ///< unit, from P to r1
  Vector3 direction2;     ///< unit, from r2 to Q

  [[nodiscard]] bool wrapped() const { return status == WrapStatus::kWrapped; }
  [[nodiscard]] Scalar length() const { return length1 + surface_length + length2; }
};

/// The value part of a scalar: decisions are taken in double, derivatives follow.
[[nodiscard]] inline double value_of(double x) { return x; }
template <typename Jet>
[[nodiscard]] inline double value_of(const Jet& x) {
  return x.a;
}
template <typename Scalar>
[[nodiscard]] Eigen::Vector3d value_of(const Eigen::Matrix<Scalar, 3, 1>& v) {
  return {value_of(v.x()), value_of(v.y()), value_of(v.z())};
}

}  // namespace veridyn::muscle
