#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "veridyn/muscle/path/path_solver.hpp"
#include "veridyn/muscle/path/segment_lanes.hpp"

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
        const MusclePaths::Add& add = paths_.variant_adds_[a];
        w_.gradient[add.pair] += w_.term[add.term];
      }
    }
  }
  for (const int muscle : paths_.general_) {
    if (!skip.empty() && skip[muscle] != 0) continue;
    w_.flag[muscle] = PathFlag::kFine;
    w_.length[muscle] = general<kGradient>(paths_.muscles_[muscle], w_.flag[muscle]);
  }
  paths_.functions_.template evaluate<kGradient>(q_, w_.length.data(), w_.gradient.data(), skip);
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
    for (const int i : paths_.points_in_ground_) at(static_cast<std::size_t>(i));
  }
  for (std::size_t i = 0; i < paths_.moving_.size(); ++i) {
    const MusclePaths::MovingPoint& moving = paths_.moving_[i];
    const Pose<Scalar>& pose = kinematics_.pose[paths_.points_[moving.point].link];
    Vector place;
    std::array<Vector, 3> slope;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int c = moving.coordinate[axis];
      if (c < 0) {
        place[axis] = Scalar(moving.still[axis]);
        continue;
      }
      const bool below = q_[c]<Scalar(moving.low[axis]), above = q_[c]> Scalar(moving.high[axis]);
      const Scalar clamped = below ? Scalar(moving.low[axis]) : (above ? Scalar(moving.high[axis]) : q_[c]);
      const numerics::FunctionValue<Scalar> f = moving.location[axis].evaluate(clamped);
      place[axis] = f.value;
      const std::size_t kept = moving.with[axis];
      if (kept == axis) slope[axis].setZero();
      slope[kept][axis] = below || above ? Scalar(0.0) : f.slope;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (moving.coordinate[axis] < 0 || moving.with[axis] != axis) continue;
      w_.moving_slope[3 * i + axis] = pose.rotation * (moving.in_link.rotation.template cast<Scalar>() * slope[axis]);
    }
    const Vector in_link =
        moving.in_link.rotation.template cast<Scalar>() * place + moving.in_link.translation.template cast<Scalar>();
    const Vector location = pose.rotation * in_link + pose.position;
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
  for (const MusclePaths::LinkPair& pair : paths_.link_pairs_) segments_between<kGradient>(pair);
  // Those with an end that moves in its link, in ground.
  for (std::size_t i = paths_.link_pairs_.empty() ? 0 : paths_.link_pairs_.back().end; i < paths_.segments_.size();
       ++i) {
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
template <bool kGradient>
inline void PathSolver<Scalar>::segments_between(const MusclePaths::LinkPair& pair) {
  using std::sqrt;
  // In the frame of the first link: one end stays, the other one is taken there, and so are the coordinates' motions.
  const Pose<Scalar>& to = kinematics_.pose[pair.a];
  const Pose<Scalar>& from = kinematics_.pose[pair.b];
  const Matrix3<Scalar> r = to.rotation.transpose() * from.rotation;
  const Vector t = to.rotation.transpose() * (from.position - to.position);
  const std::size_t n = pair.coordinates.size(), stride = pair.end - pair.first;
  if constexpr (kGradient) {
    for (std::size_t j = 0; j < n; ++j) {
      const SpatialVector<Scalar>& column = kinematics_.columns[pair.coordinates[j]];
      const Vector linear = column.linear + column.angular.cross(to.position);
      w_.local_column[j].angular = to.rotation.transpose() * (column.angular * Scalar(pair.signs[j]));
      w_.local_column[j].linear = to.rotation.transpose() * (linear * Scalar(pair.signs[j]));
    }
  }
  const auto& a = paths_.end_a_;
  const auto& b = paths_.end_b_;
  if constexpr (std::is_same_v<Scalar, double>) {
    internal::SegmentLanes lanes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lanes.a[axis] = &a[axis][pair.first];
      lanes.b[axis] = &b[axis][pair.first];
    }
    static_assert(sizeof(SpatialVector<double>) == 6 * sizeof(double));
    lanes.n = stride;
    lanes.r = r.data();
    lanes.t = t.data();
    lanes.length = &w_.segment_length[pair.first];
    if (kGradient && n > 0) {
      lanes.motion = w_.local_column[0].angular.data();
      lanes.coordinates = n;
      lanes.term = &w_.term[pair.terms];
    }
    internal::compute(lanes);
  } else {
    for (std::size_t i = pair.first; i < pair.end; ++i) {
      const Vector x{Scalar(a[0][i]), Scalar(a[1][i]), Scalar(a[2][i])};
      const Vector u = r * Vector{Scalar(b[0][i]), Scalar(b[1][i]), Scalar(b[2][i])} + (t - x);
      const Scalar length = sqrt(u.squaredNorm());
      w_.segment_length[i] = length;
      if constexpr (kGradient) {
        const Vector d = u / length;
        const Vector m = x.cross(d);
        for (std::size_t j = 0; j < n; ++j)
          w_.term[pair.terms + j * stride + i - pair.first] =
              w_.local_column[j].angular.dot(m) + w_.local_column[j].linear.dot(d);
      }
    }
  }
}

}  // namespace veridyn::muscle
