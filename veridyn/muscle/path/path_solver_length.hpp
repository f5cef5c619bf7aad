#pragma once

#include <cmath>

#include "veridyn/muscle/path/path_solver.hpp"

/// Length and gradient of a path whose nodes are known, and of one that comes off cylinders.
namespace veridyn::muscle {

template <typename Scalar>
template <bool kGradient>
inline Scalar PathSolver<Scalar>::general(const Path& path, PathFlag& flag) {
  stations(path);
  if (n_stations_ < 2) return Scalar(0.0);
  const bool any = detect(path, flag);
  unsigned fading = 0;
  for (std::size_t i = 0; any && i < path.wraps.size(); ++i)
    if (w_.first_segment[i] >= 0 && w_.first[i]->weight < Scalar(1.0)) fading |= 1u << i;
  if (fading == 0 || paths_.mode_ == WrapMode::kAsOpenSim)
    return measure<kGradient>(path, solve(path, any ? ~0u : 0u), Scalar(1.0));
  return letting_go<kGradient>(path, ~0u, fading, Scalar(1.0));
}

template <typename Scalar>
inline void PathSolver<Scalar>::pull(int muscle, const Scalar& tension, SpatialVector<Scalar>* by_link) {
  by_link_ = by_link;
  tension_ = tension;
  PathFlag flag = PathFlag::kFine;
  general<true>(paths_.muscles_[muscle], flag);
  by_link_ = nullptr;
}

template <typename Scalar>
template <bool kGradient>
inline Scalar PathSolver<Scalar>::letting_go(const Path& path, unsigned mask, unsigned fading, const Scalar& factor) {
  if (fading == 0) return measure<kGradient>(path, solve(path, mask), factor);
  std::size_t i = 0;
  while ((fading >> i & 1u) == 0) ++i;
  const unsigned bit = 1u << i, others = fading & ~bit;
  const WrapResult<Scalar>& wrap = *w_.first[i];
  const Scalar with = letting_go<kGradient>(path, mask, others, Scalar(factor * wrap.weight));
  const Scalar without = letting_go<kGradient>(path, mask & ~bit, others, Scalar(factor * (Scalar(1.0) - wrap.weight)));
  if constexpr (kGradient) {
    const Node a = w_.stations[w_.first_segment[i]];
    const Node b = w_.stations[w_.first_segment[i] + 1];
    const Scalar change = factor * (with - without);
    const int link = paths_.objects_[path.wraps[i].object].link;
    add_string(path, change, a.x, wrap.weight_p, link, a.link);
    add_string(path, change, b.x, wrap.weight_q, link, b.link);
    add_moving(path, change, a.point, wrap.weight_p);
    add_moving(path, change, b.point, wrap.weight_q);
  }
  return without + wrap.weight * (with - without);
}

template <typename Scalar>
template <bool kGradient>
inline Scalar PathSolver<Scalar>::measure(const Path& path, std::size_t n, const Scalar& factor) {
  using std::sqrt;
  Scalar length(0.0);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const Node& a = w_.nodes[k];
    const Node& b = w_.nodes[k + 1];
    if (a.wrap >= 0 && a.wrap == b.wrap) {
      const WrapResult<Scalar>& r = *w_.result[a.wrap];
      length += r.surface_length;
      if constexpr (kGradient) {
        if (r.depth > 0.0 && paths_.mode_ == WrapMode::kTaut) {
          // An end that shrinks the object: an extra force there, its opposite on the object.
          const Node& p = w_.nodes[k - 1];
          const Node& q = w_.nodes[k + 2];
          const Vector extra_p = r.gradient_p + r.direction1;
          const Vector extra_q = r.gradient_q - r.direction2;
          add_string(path, factor, p.x, extra_p, a.link, p.link);
          add_string(path, factor, q.x, extra_q, a.link, q.link);
          if (p.point >= 0) add_moving(path, factor, p.point, extra_p);
          if (q.point >= 0) add_moving(path, factor, q.point, extra_q);
        }
      }
      continue;
    }
    if (a.station >= 0 && b.station == a.station + 1) {
      const double fixed = path.fixed[a.station];
      if (fixed >= 0.0) {
        length += fixed;
        continue;
      }
    }
    const Vector u = b.x - a.x;
    const Scalar l2 = u.squaredNorm();
    if (!(value_of(l2) > 0.0)) continue;
    const Scalar l = sqrt(l2);
    length += l;
    if constexpr (kGradient) {
      const bool moving = (a.point >= 0 && is_moving(a.point)) || (b.point >= 0 && is_moving(b.point));
      if (a.link == b.link && !moving) continue;
      const Vector d = u / l;
      if (a.link != b.link) add_string(path, factor, a.x, d, a.link, b.link);
      if (moving) {
        if (a.point >= 0) add_moving(path, factor, a.point, Vector(-d));
        if (b.point >= 0) add_moving(path, factor, b.point, d);
      }
    }
  }
  return length;
}

template <typename Scalar>
inline void PathSolver<Scalar>::add_string(const Path& path, const Scalar& factor, const Vector& x, const Vector& g,
                                           int from, int to) {
  const Vector m = x.cross(g);
  if (by_link_ != nullptr) {
    const SpatialVector<Scalar> wrench{m, g};
    by_link_[from].add_scaled(tension_ * factor, wrench);
    by_link_[to].add_scaled(Scalar(-tension_ * factor), wrench);
  }
  for (std::size_t k = path.pairs[0]; k < path.pairs[1]; ++k) {
    const int c = paths_.pairs_[k].coordinate;
    const int sign = static_cast<int>(paths_.moves(c, to)) - static_cast<int>(paths_.moves(c, from));
    if (sign == 0) continue;
    const SpatialVector<Scalar>& column = kinematics_.columns[c];
    const Scalar along = factor * (column.angular.dot(m) + column.linear.dot(g));
    w_.gradient[k] += sign > 0 ? along : Scalar(-along);
  }
}

template <typename Scalar>
inline void PathSolver<Scalar>::add_moving(const Path& path, const Scalar& factor, int point, const Vector& g) {
  const int index = paths_.points_[point].moving;
  if (index < 0) return;
  const MusclePaths::MovingPoint& moving = paths_.moving_[index];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (moving.coordinate[axis] < 0 || moving.with[axis] != axis) continue;
    for (std::size_t k = path.pairs[0]; k < path.pairs[1]; ++k) {
      if (paths_.pairs_[k].coordinate != moving.coordinate[axis]) continue;
      w_.gradient[k] += factor * g.dot(w_.moving_slope[3 * static_cast<std::size_t>(index) + axis]);
    }
  }
}

}  // namespace veridyn::muscle
