#pragma once

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/dynamics/mechanism.hpp"
#include "veridyn/muscle/model/loop_constraint.hpp"
#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/model/scalar.hpp"

namespace veridyn::muscle {

/// One scalar equation error(q) = 0 of a constraint. Its rate is force . (V2 - V1) with the velocities of the two
/// links, so that `force` is also what a unit multiplier does to link 2; link 1 gets the opposite.
template <typename Scalar>
struct LoopRow {
  Scalar error{};               ///< [m], or of an orientation the cosine of an angle that should be right
  SpatialVector<Scalar> force;  ///< moment about the ground's origin
  Scalar rate{};                ///< of the error
  Scalar rate_bias{};           ///< d(force)/dt . (V2 - V1)
  double reach = 0.0;           ///< from the ground's origin to where the force acts; 0 of a moment [m]
};

/// The constraints of a model that close loops, compiled. Immutable; used by many threads at once.
///
/// With e_i fixed in body 1, p a point of body 2 and c one of body 1:
///
///     point:          e_i . (p - c), i = x, y, z
///     point on line:  e_i . (p - c), i across the line
///     distance:       ((p - c)^2 - L^2)/(2 L)
///     weld:           those of a point, and x1 . y2, y1 . z2, z1 . x2
class LoopConstraints {
 public:
  /// Constraints between bodies that are welded to each other are left out. @throws InputError naming one that does
  /// not hold there, or has no distance.
  LoopConstraints(const Model& model, const Mechanism& mechanism);

  /// One constraint, as its links see it.
  struct Constraint {
    std::string text;  ///< for messages
    LoopKind kind = LoopKind::kPoint;
    int link_1 = 0, link_2 = 0;
    Placement frame_1, frame_2;  ///< in their links
    double distance = 0.0;
    int first_row = 0, rows = 0;
  };

  [[nodiscard]] bool empty() const { return constraints_.empty(); }
  [[nodiscard]] int rows() const { return static_cast<int>(row_constraint_.size()); }
  [[nodiscard]] std::span<const Constraint> constraints() const { return constraints_; }
  /// The constraint that a row belongs to.
  [[nodiscard]] const Constraint& of_row(int row) const { return constraints_[row_constraint_[row]]; }
  /// Coordinates that move one of a row's links but not the other.
  [[nodiscard]] std::span<const int> moving_2(int row) const { return moving_2_[row_constraint_[row]]; }
  [[nodiscard]] std::span<const int> moving_1(int row) const { return moving_1_[row_constraint_[row]]; }

  /// The link whose joint a coordinate belongs to.
  [[nodiscard]] int link_of(int coordinate) const { return coordinate_link_[coordinate]; }

  /// All rows for kinematics whose velocities are set. Does not allocate.
  template <typename Scalar>
  void evaluate(const Kinematics<Scalar>& kinematics, LoopRow<Scalar>* rows) const {
    for (const Constraint& constraint : constraints_) evaluate(constraint, kinematics, rows + constraint.first_row);
  }

 private:
  static void check_at_rest(const Constraint& constraint, const Mechanism& mechanism);
  template <typename Scalar>
  static void evaluate(const Constraint& constraint, const Kinematics<Scalar>& kinematics, LoopRow<Scalar>* row);

  std::vector<Constraint> constraints_;
  std::vector<int> row_constraint_, coordinate_link_;
  std::vector<std::vector<int>> moving_1_, moving_2_;  ///< by constraint
};

// Details ------------------------------------------------------------------------------------------------------------

namespace internal {

/// Row of a point p of link 2 along a direction e that turns with angular velocity w.
template <typename Scalar>
LoopRow<Scalar> point_row(const Vector3<Scalar>& p, const Vector3<Scalar>& p_rate, const Vector3<Scalar>& e,
                          const Vector3<Scalar>& e_rate, const Scalar& error, const SpatialVector<Scalar>& relative) {
  LoopRow<Scalar> row;
  row.error = error;
  row.force = {p.cross(e), e};
  row.rate = row.force.dot(relative);
  row.reach = std::sqrt(value_of(p.squaredNorm()));
  row.rate_bias = SpatialVector<Scalar>{p_rate.cross(e) + p.cross(e_rate), e_rate}.dot(relative);
  return row;
}

}  // namespace internal

template <typename Scalar>
void LoopConstraints::evaluate(const Constraint& constraint, const Kinematics<Scalar>& kinematics,
                               LoopRow<Scalar>* row) {
  const Pose<Scalar>& pose_1 = kinematics.pose[constraint.link_1];
  const Pose<Scalar>& pose_2 = kinematics.pose[constraint.link_2];
  const SpatialVector<Scalar>& V1 = kinematics.velocity[constraint.link_1];
  const SpatialVector<Scalar>& V2 = kinematics.velocity[constraint.link_2];
  const SpatialVector<Scalar> relative{V2.angular - V1.angular, V2.linear - V1.linear};
  const Vector3<Scalar> c = pose_1 * constraint.frame_1.translation, p = pose_2 * constraint.frame_2.translation;
  const Vector3<Scalar> d = p - c, p_rate = V2.at(p);
  if (constraint.kind == LoopKind::kDistance) {
    const Scalar per_length(1.0 / constraint.distance);
    const Vector3<Scalar> e = d * per_length, e_rate = (p_rate - V1.at(c)) * per_length;
    const Scalar error = (d.squaredNorm() * per_length - Scalar(constraint.distance)) * Scalar(0.5);
    *row = internal::point_row(p, p_rate, e, e_rate, error, relative);
    return;
  }
  const Matrix3<Scalar> axes_1 = internal::rotate(pose_1.rotation, constraint.frame_1.rotation);
  for (int i = constraint.kind == LoopKind::kPointOnLine ? 1 : 0; i < 3; ++i) {
    const Vector3<Scalar> e = axes_1.col(i), e_rate = V1.angular.cross(e);
    *row++ = internal::point_row(p, p_rate, e, e_rate, Scalar(e.dot(d)), relative);
  }
  if (constraint.kind != LoopKind::kWeld) return;
  const Matrix3<Scalar> axes_2 = internal::rotate(pose_2.rotation, constraint.frame_2.rotation);
  for (int i = 0; i < 3; ++i) {
    const Vector3<Scalar> a = axes_1.col(i), b = axes_2.col((i + 1) % 3);
    const Vector3<Scalar> a_rate = V1.angular.cross(a), b_rate = V2.angular.cross(b);
    row->error = a.dot(b);
    row->force = {b.cross(a), Vector3<Scalar>::Zero()};
    row->reach = 0.0;
    row->rate = row->force.angular.dot(relative.angular);
    row->rate_bias = (b_rate.cross(a) + b.cross(a_rate)).dot(relative.angular);
    ++row;
  }
}

}  // namespace veridyn::muscle
