#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "veridyn/muscle/path/path_solver.hpp"

/// What needs no wrapping: points and wrap objects in ground, straight segments, paths that are sums of them.
namespace veridyn::muscle {

template <typename Scalar>
PathSolver<Scalar>::PathSolver(const MusclePaths& paths, const Kinematics<Scalar>& kinematics, const Scalar* q,
                               PathWorkspace<Scalar>& workspace, PathPlaces places)
    : paths_(paths), kinematics_(kinematics), q_(q), w_(workspace) {
  std::fill(w_.span_known.begin(), w_.span_known.end(), std::uint8_t{0});
  place(places);
}

template <typename Scalar>
template <bool kGradient>
inline void PathSolver<Scalar>::all(std::span<const std::uint8_t> skip) {
  segments<kGradient>();
  if constexpr (kGradient) std::fill(w_.gradient.begin(), w_.gradient.end(), Scalar(0.0));
  for (const MusclePaths::StraightPath& path : paths_.straight_) {
    std::size_t held = 0;
    for (std::size_t c = path.conditions; c < path.end_conditions; ++c) {
      const MusclePaths::Condition& condition = paths_.conditions_[c];
      if (condition.holds(value_of(q_[condition.coordinate]))) held |= std::size_t{1} << (c - path.conditions);
    }
    const MusclePaths::Variant& variant = paths_.variants_[path.variants + held];
    Scalar length(variant.constant);
    for (std::size_t s = variant.segments; s < variant.end_segments; ++s)
      length += w_.segment_length[paths_.variant_segments_[s]];
    w_.length[path.muscle] = length;
    if constexpr (kGradient) {
      for (std::size_t a = variant.adds; a < variant.end_adds; ++a) {
        const auto& [term, pair] = paths_.variant_adds_[a];
        w_.gradient[pair] += w_.term[term];
      }
    }
  }
  for (const int muscle : paths_.general_) {
    if (!skip.empty() && skip[muscle] != 0) continue;
    w_.flag[muscle] = PathFlag::kFine;
    w_.length[muscle] = general<kGradient>(paths_.muscles_[muscle], w_.flag[muscle]);
  }
}

template <typename Scalar>
inline void PathSolver<Scalar>::place(PathPlaces places) {
  const auto at = [&](std::size_t i) {
    const MusclePaths::Point& point = paths_.points_[i];
    w_.position[i] = kinematics_.pose[point.link] * point.location;
  };
  if (places == PathPlaces::kEvery) {
    for (std::size_t i = 0; i < paths_.points_.size(); ++i)
      if (paths_.points_[i].moving < 0) at(i);
  } else {
    for (const int i : places == PathPlaces::kForAll ? paths_.points_for_all_ : paths_.points_for_lengths_)
      at(static_cast<std::size_t>(i));
  }
  for (std::size_t i = 0; i < paths_.moving_.size(); ++i) {
    const MusclePaths::MovingPoint& moving = paths_.moving_[i];
    const Pose<Scalar>& pose = kinematics_.pose[paths_.points_[moving.point].link];
    Vector location = pose * moving.in_link.translation;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector direction = pose.rotation * moving.in_link.rotation.col(axis).template cast<Scalar>();
      const int c = moving.coordinate[axis];
      numerics::FunctionValue<Scalar> f;
      if (c >= 0 && (q_[c] < Scalar(moving.low[axis]) || q_[c] > Scalar(moving.high[axis]))) {
        f.value = moving.location[axis]
                      .evaluate(Scalar(q_[c] < Scalar(moving.low[axis]) ? moving.low[axis] : moving.high[axis]))
                      .value;
      } else {
        f = moving.location[axis].evaluate(c >= 0 ? q_[c] : Scalar(0.0));
      }
      location += direction * f.value;
      w_.moving_slope[3 * i + axis] = direction * f.slope;
    }
    w_.position[moving.point] = location;
  }
  for (std::size_t i = 0; i < paths_.objects_.size(); ++i) {
    const MusclePaths::Object& object = paths_.objects_[i];
    const Pose<Scalar>& pose = kinematics_.pose[object.link];
    w_.object[i].rotation = pose.rotation * object.in_link.rotation.template cast<Scalar>();
    w_.object[i].position = pose * object.in_link.translation;
  }
}

template <typename Scalar>
template <bool kGradient>
inline void PathSolver<Scalar>::segments() {
  using std::sqrt;
  std::size_t first_in_ground = 0;
  if constexpr (!kGradient) {
    // Lengths alone do not need ground: one end is taken to the other's link, all segments of two links together.
    for (const MusclePaths::LinkPair& pair : paths_.link_pairs_) lengths_between(pair);
    if (!paths_.link_pairs_.empty()) first_in_ground = paths_.link_pairs_.back().end;
  }
  for (std::size_t i = first_in_ground; i < paths_.segments_.size(); ++i) {
    const MusclePaths::Segment& s = paths_.segments_[i];
    const Vector& a = w_.position[s.a];
    const Vector u = w_.position[s.b] - a;
    const Scalar length = sqrt(u.squaredNorm());
    w_.segment_length[i] = length;
    if constexpr (kGradient) {
      const Vector d = u / length;
      const Vector m = a.cross(d);
      for (std::size_t t = s.terms[0]; t < s.terms[1]; ++t) {
        const MusclePaths::Term& term = paths_.terms_[t];
        if (term.moving >= 0) {
          const Scalar along = d.dot(w_.moving_slope[term.moving]);
          w_.term[t] = term.sign > 0 ? along : Scalar(-along);
        } else {
          const SpatialVector<Scalar>& column = kinematics_.columns[term.coordinate];
          const Scalar along = column.angular.dot(m) + column.linear.dot(d);
          w_.term[t] = term.sign > 0 ? along : Scalar(-along);
        }
      }
    }
  }
}

template <typename Scalar>
inline void PathSolver<Scalar>::lengths_between(const MusclePaths::LinkPair& pair) {
  using std::sqrt;
  const Pose<Scalar>& to = kinematics_.pose[pair.a];
  const Pose<Scalar>& from = kinematics_.pose[pair.b];
  const Matrix3<Scalar> r = to.rotation.transpose() * from.rotation;
  const Vector t = to.rotation.transpose() * (from.position - to.position);
  const double* ax = paths_.end_a_[0].data();
  const double* ay = paths_.end_a_[1].data();
  const double* az = paths_.end_a_[2].data();
  const double* bx = paths_.end_b_[0].data();
  const double* by = paths_.end_b_[1].data();
  const double* bz = paths_.end_b_[2].data();
  Scalar* length = w_.segment_length.data();
  for (std::size_t i = pair.first; i < pair.end; ++i) {
    const Scalar x = t.x() + r(0, 0) * bx[i] + r(0, 1) * by[i] + r(0, 2) * bz[i] - ax[i];
    const Scalar y = t.y() + r(1, 0) * bx[i] + r(1, 1) * by[i] + r(1, 2) * bz[i] - ay[i];
    const Scalar z = t.z() + r(2, 0) * bx[i] + r(2, 1) * by[i] + r(2, 2) * bz[i] - az[i];
    length[i] = x * x + y * y + z * z;
  }
  if constexpr (std::is_same_v<Scalar, double>) {
    // As an array, so that roots are taken two at a time.
    Eigen::Map<Eigen::ArrayXd> roots(length + pair.first, pair.end - pair.first);
    roots = roots.sqrt();
  } else {
    for (std::size_t i = pair.first; i < pair.end; ++i) length[i] = sqrt(length[i]);
  }
}

}  // namespace veridyn::muscle
