#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/path/path_solver.hpp"

/// Over which objects a path goes, and where it touches them.
namespace veridyn::muscle {

template <typename Scalar>
inline std::size_t PathSolver<Scalar>::nodes_of(int muscle) {
  PathFlag flag = PathFlag::kFine;
  const Path& path = paths_.muscles_[muscle];
  if (path.stations.empty()) return 0;
  stations(path);
  detect(path, flag);
  return solve(path, ~0u);
}

template <typename Scalar>
inline bool PathSolver<Scalar>::wrap_between(const MusclePaths::Object& object, int index,
                                             const MusclePaths::Wrap& wrap, bool single, const Vector& p_ground,
                                             const Vector& q_ground, WrapResult<Scalar>& r,
                                             internal::GeodesicMemory* memory) {
  const auto& frame = w_.object[index];
  // Most segments pass far from most objects.
  if (object.reach > 0.0) {
    const Eigen::Vector3d a = value_of(Vector(p_ground - frame.position));
    const Eigen::Vector3d b = value_of(Vector(q_ground - p_ground));
    const double a2 = a.squaredNorm(), b2 = b.squaredNorm(), along = -a.dot(b),
                 r2 = 1.00001 * object.reach * object.reach;
    const bool beside = !(along > 0.0 && along < b2) || a2 * b2 - along * along > r2 * b2;
    if (beside && a2 > r2 && a2 - 2.0 * along + b2 > r2) {
      r.clear();
      return false;
    }
  } else if (object.shape == WrapShape::kCylinder && paths_.mode_ == WrapMode::kTaut) {
    const Eigen::Vector3d x = value_of(Vector(frame.rotation.col(0)));
    const Eigen::Vector3d y = value_of(Vector(frame.rotation.col(1)));
    const Eigen::Vector3d p = value_of(Vector(p_ground - frame.position));
    const Eigen::Vector3d q = value_of(Vector(q_ground - frame.position));
    const internal::CylinderPass pass =
        internal::cylinder_pass(object.cylinder, x.dot(p), y.dot(p), x.dot(q), y.dot(q));
    const double r2 = object.cylinder.radius * object.cylinder.radius * 1.00001;
    if (!pass.meets && !pass.long_way && pass.p2 > r2 && pass.q2 > r2) {
      r.clear();
      return false;
    }
  }
  const Vector p = frame.rotation.transpose() * (p_ground - frame.position);
  const Vector q = frame.rotation.transpose() * (q_ground - frame.position);
  if (paths_.mode_ == WrapMode::kAsOpenSim) {
    r = as_opensim(object, wrap, single, p, q);
  } else {
    switch (object.shape) {
      case WrapShape::kSphere:
        internal::wrap_onto(object.sphere, p, q, wrap.alone, r);
        break;
      case WrapShape::kCylinder:
        internal::wrap_onto(object.cylinder, p, q, wrap.alone, r);
        break;
      case WrapShape::kEllipsoid:
        if (side_ == 0) {
          internal::wrap_onto(object.ellipsoid, p, q, wrap.alone, memory, r);
        } else {
          WrapEllipsoid one_side = object.ellipsoid;
          one_side.side = side_;
          internal::wrap_onto(one_side, p, q, wrap.alone, memory, r);
        }
        break;
      case WrapShape::kTorus:
        r = muscle::wrap(object.torus, p, q);
        break;
    }
  }
  if (!r.wrapped()) return false;
  r.r1 = frame.rotation * r.r1 + frame.position;
  r.r2 = frame.rotation * r.r2 + frame.position;
  // The straight parts' directions follow from the points; these are needed only where an end dips in.
  if (r.depth > 0.0) {
    r.direction1 = frame.rotation * r.direction1;
    r.direction2 = frame.rotation * r.direction2;
    r.gradient_p = frame.rotation * r.gradient_p;
    r.gradient_q = frame.rotation * r.gradient_q;
  }
  if (r.weight < Scalar(1.0)) {
    r.weight_p = frame.rotation * r.weight_p;
    r.weight_q = frame.rotation * r.weight_q;
  }
  return true;
}

template <typename Scalar>
inline void PathSolver<Scalar>::stations(const Path& path) {
  n_stations_ = 0;
  for (std::size_t i = 0; i < path.stations.size(); ++i) {
    const MusclePaths::PathStation& station = path.stations[i];
    if (station.condition >= 0 &&
        !MusclePaths::Condition{station.condition, station.low, station.high}.holds(value_of(q_[station.condition])))
      continue;
    Node& node = w_.stations[n_stations_++];
    node.x = w_.position[station.point];
    node.link = paths_.points_[station.point].link;
    node.point = station.point;
    node.station = static_cast<int>(i);
    node.wrap = -1;
  }
}

template <typename Scalar>
inline bool PathSolver<Scalar>::detect(const Path& path, PathFlag& flag) {
  bool any = false;
  for (std::size_t i = 0; i < path.wraps.size(); ++i) {
    const MusclePaths::Wrap& wrap = path.wraps[i];
    const MusclePaths::Object& object = paths_.objects_[wrap.object];
    w_.first_segment[i] = -1;
    double least = 1e300;
    // Without conditional points every station is there.
    const bool every = !wrap.spans.empty();
    const std::size_t end = every ? static_cast<std::size_t>(wrap.last) : n_stations_ - 1;
    for (std::size_t k = every ? static_cast<std::size_t>(wrap.first) : 0; k < end; ++k) {
      const Node& a = w_.stations[k];
      const Node& b = w_.stations[k + 1];
      if (a.station < wrap.first || b.station > wrap.last) continue;
      const WrapResult<Scalar>* r = &w_.fresh;
      if (!wrap.spans.empty()) {
        const int s = wrap.spans[a.station - wrap.first];
        if (s < 0) continue;
        if (!w_.span_known[s]) {
          wrap_between(object, wrap.object, wrap, path.wraps.size() == 1, a.x, b.x, w_.span[s]);
          w_.span_known[s] = 1;
        }
        r = &w_.span[s];
      } else {
        wrap_between(object, wrap.object, wrap, path.wraps.size() == 1, a.x, b.x, w_.fresh);
      }
      if (r->status == WrapStatus::kFailed) flag = std::max(flag, PathFlag::kFailed);
      if (!r->wrapped()) continue;
      const double longer = value_of(r->length) - value_of(Vector(b.x - a.x)).norm();
      if (r->meets || longer < least) {
        if (r == &w_.fresh) {
          w_.first_solved[i] = w_.fresh;
          r = &w_.first_solved[i];
        }
        w_.first[i] = r;
        w_.first_segment[i] = static_cast<int>(k);
        least = longer;
        any = true;
      }
      if (r->meets) break;
    }
    if (w_.first_segment[i] >= 0 && w_.first[i]->weight < Scalar(1.0)) flag = std::max(flag, PathFlag::kFading);
  }
  return any;
}

template <typename Scalar>
inline bool PathSolver<Scalar>::crossing(std::size_t n) const {
  if (!settled_) return true;
  for (std::size_t k = 1; k + 2 < n; ++k) {
    const Node& a = w_.nodes[k];
    if (a.wrap < 0 || a.wrap != w_.nodes[k + 1].wrap) continue;
    const bool between = w_.nodes[k - 1].point < 0 || w_.nodes[k + 2].point < 0;
    if (between && w_.result[a.wrap]->depth > 0.0) return true;
  }
  return false;
}

template <typename Scalar>
inline std::size_t PathSolver<Scalar>::solve(const Path& path, unsigned mask) {
  std::size_t n = solve_all(path, mask);
  if (!path.coupled || paths_.mode_ == WrapMode::kAsOpenSim || !crossing(n)) return n;
  // A string cannot run over objects that cross: of the fewer ones over which it can, those that it goes round
  // farthest.
  const unsigned all = mask & ((1u << path.wraps.size()) - 1u);
  double longest = -1.0;
  swap_with_other();
  for (unsigned part = (all - 1u) & all; part != 0u; part = (part - 1u) & all) {
    const std::size_t count = settle(path, part);
    if (crossing(count)) continue;
    const double length = muscle::value_of(measure<false>(path, count, Scalar(1.0)));
    if (length <= longest) continue;
    longest = length;
    n = count;
    swap_with_other();
  }
  swap_with_other();
  return n;
}

template <typename Scalar>
inline std::size_t PathSolver<Scalar>::solve_all(const Path& path, unsigned mask) {
  const std::size_t n = settle(path, mask);
  if (!path.coupled || paths_.mode_ == WrapMode::kAsOpenSim) return n;
  double spread = 1.0;
  for (std::size_t k = 0; k < n; ++k)
    if (w_.nodes[k].wrap >= 0) spread = std::min(spread, w_.result[w_.nodes[k].wrap]->spread);
  if (spread >= 0.7) return n;
  // Objects solved one after the other may settle on the longer of two sides: try the other one too.
  bool settled = settled_;
  const double length = muscle::value_of(measure<false>(path, n, Scalar(1.0)));
  double other_length = length;
  std::size_t other_n = n;
  swap_with_other();
  for (const int side : {1, -1}) {
    side_ = side;
    give_up_ = other_length + kNearlySettled;
    other_n_ = other_n;
    const std::size_t count = settle(path, mask);
    const double l = muscle::value_of(measure<false>(path, count, Scalar(1.0)));
    if (!repeats_ && l < other_length - 1e-12) {
      other_length = l;
      other_n = count;
      settled = settled_;
      swap_with_other();
    }
  }
  side_ = 0;
  settled_ = settled;
  swap_with_other();
  return other_n;
}

template <typename Scalar>
inline void PathSolver<Scalar>::swap_with_other() {
  std::swap(w_.nodes, w_.other_nodes);
  std::swap(w_.result, w_.other_result);
  std::swap(w_.result_solved, w_.other_result_solved);
}

template <typename Scalar>
inline bool PathSolver<Scalar>::as_before(std::size_t n) const {
  if (n != other_n_) return false;
  for (std::size_t k = 0; k < n; ++k)
    if (w_.nodes[k].wrap != w_.other_nodes[k].wrap ||
        !(value_of(Vector(w_.nodes[k].x - w_.other_nodes[k].x)).norm() < kNearlySettled))
      return false;
  return true;
}

template <typename Scalar>
inline std::size_t PathSolver<Scalar>::settle(const Path& path, unsigned mask) {
  std::copy_n(w_.stations.begin(), n_stations_, w_.nodes.begin());
  std::size_t n = n_stations_;
  settled_ = true;
  if (!path.coupled) {
    for (std::size_t i = 0; i < path.wraps.size(); ++i) {
      if ((mask >> i & 1u) == 0 || w_.first_segment[i] < 0) continue;
      w_.result[i] = w_.first[i];
      const int station = w_.stations[w_.first_segment[i]].station;
      auto at = static_cast<std::size_t>(w_.first_segment[i]);
      while (w_.nodes[at].station != station) ++at;
      insert(path, i, at, n);
    }
    return n;
  }
  if (paths_.mode_ == WrapMode::kAsOpenSim) return solve_as_opensim(path, n);
  for (std::size_t i = 0; i < path.wraps.size(); ++i) w_.memory[i].clear();
  repeats_ = false;
  // Jets continue for their derivatives after the values have settled.
  int more = std::is_same_v<Scalar, double> ? 0 : 8;
  // An object is solved again only where another one on the path has changed since.
  std::array<int, 32> solved_at, changed_at;
  std::fill_n(changed_at.begin(), path.wraps.size(), -1);
  std::fill_n(solved_at.begin(), path.wraps.size(), -1);
  int step = 0;
  Acceleration acceleration;
  bool settled = false;
  int changes = 0;  // of which objects are on the path, and in which order
  for (int pass = 0; pass < kMostPasses && changes < kMostChanges; ++pass) {
    double moved = 0.0;
    for (std::size_t i = 0; i < path.wraps.size(); ++i) {
      if ((mask >> i & 1u) == 0) continue;
      if (pass > 0) {
        bool same = true;
        for (std::size_t k = 0; k < path.wraps.size(); ++k)
          if (k != i && changed_at[k] > solved_at[i]) same = false;
        if (same) continue;
      }
      solved_at[i] = ++step;
      const MusclePaths::Wrap& wrap = path.wraps[i];
      const WrapResult<Scalar>* was = w_.result[i];
      const std::size_t was_at = remove(static_cast<int>(i), n);
      const bool was_there = was_at > 0;
      const std::size_t at = choose(i, wrap, n);
      if (at < n) {
        insert(path, i, at, n);
        if (at + 1 != was_at) {  // new, or on another segment: two objects may go on overtaking each other
          moved = 1.0;
          changed_at[i] = step;
        } else if (w_.result[i] != was || was == &w_.result_solved[i]) {
          const double by = std::max(value_of(Vector(w_.result[i]->r1 - w_.before[2 * i])).norm(),
                                     value_of(Vector(w_.result[i]->r2 - w_.before[2 * i + 1])).norm());
          moved = std::max(moved, by);
          if (by > 0.0 || !std::is_same_v<Scalar, double>) changed_at[i] = step;
        }
        // Where it was, for the acceleration.
        w_.start[2 * i] = w_.before[2 * i];
        w_.start[2 * i + 1] = w_.before[2 * i + 1];
        w_.before[2 * i] = w_.result[i]->r1;
        w_.before[2 * i + 1] = w_.result[i]->r2;
      } else if (was_there) {
        moved = 1.0;
        changed_at[i] = step;
      }
    }
    changes += moved >= 1.0 ? 1 : 0;
    settled = moved == 0.0 || (pass > 0 && moved < 1e-10 && more-- <= 0);
    if (settled) break;
    // Nearly settled tangent points show which solution they approach; the length is stationary and shows whether it
    // is longer.
    if (side_ != 0 && moved < kNearlySettled) {
      repeats_ = as_before(n);
      settled = repeats_ || muscle::value_of(measure<false>(path, n, Scalar(1.0))) > give_up_;
      if (settled) break;
    }
    if constexpr (std::is_same_v<Scalar, double>) {
      // By itself each pass shortens the path; with acceleration it may go astray.
      if (pass > 0 && pass < kAcceleratedPasses) accelerate(n, moved, acceleration);
    }
  }
  settled_ = settled;
  return n;
}

template <typename Scalar>
inline void PathSolver<Scalar>::accelerate(std::size_t n, double moved, Acceleration& a) {
  // The two objects whose ends are tangent points of another one.
  std::size_t found = 0, later = 0;
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const int wrap = w_.nodes[k].wrap;
    if (wrap < 0 || wrap != w_.nodes[k + 1].wrap) continue;
    if (w_.result[wrap] != &w_.result_solved[wrap]) continue;
    ++found;
    later = std::max(later, at(wrap));
  }
  if (found != 2 || moved >= 1.0) {
    a.known = 0;
    return;
  }
  std::size_t k = 0;
  while (w_.nodes[k].wrap != static_cast<int>(later)) ++k;
  std::size_t side = 0;
  if (k > 0 && w_.nodes[k - 1].wrap >= 0) {
    side = 0;
  } else if (k + 2 < n && w_.nodes[k + 2].wrap >= 0) {
    side = 1;
  } else {
    return;
  }
  const Eigen::Vector3d image = value_of(w_.before[2 * later + side]);
  const Eigen::Vector3d residual = image - value_of(w_.start[2 * later + side]);
  if (a.known > 0) {
    a.residual_change.col(1) = a.residual_change.col(0);
    a.image_change.col(1) = a.image_change.col(0);
    a.residual_change.col(0) = residual - a.residual;
    a.image_change.col(0) = image - a.image;
  }
  a.residual = residual;
  a.image = image;
  ++a.known;
  if (a.known < 2) return;
  const Eigen::Vector3d d0 = a.residual_change.col(0);
  const double g00 = d0.squaredNorm(), b0 = d0.dot(residual);
  if (!(g00 > 0.0)) return;
  Eigen::Vector3d next = image - a.image_change.col(0) * (b0 / g00);
  if (a.known > 2) {
    const Eigen::Vector3d d1 = a.residual_change.col(1);
    const double g11 = d1.squaredNorm(), g01 = d0.dot(d1), b1 = d1.dot(residual);
    const double det = g00 * g11 - g01 * g01;
    if (det > 1e-6 * g00 * g11)
      next = image - a.image_change.col(0) * ((b0 * g11 - b1 * g01) / det) -
             a.image_change.col(1) * ((b1 * g00 - b0 * g01) / det);
  }
  if (!((next - image).norm() < 20.0 * residual.norm())) return;
  w_.nodes[k + side].x = next;
  w_.before[2 * later + side] = next;
}

template <typename Scalar>
inline std::size_t PathSolver<Scalar>::remove(int wrap, std::size_t& n) {
  for (std::size_t j = 0; j < n; ++j) {
    if (w_.nodes[j].wrap != wrap) continue;
    for (std::size_t k = j; k + 2 < n; ++k) w_.nodes[k] = w_.nodes[k + 2];
    n -= 2;
    return j;
  }
  return 0;
}

template <typename Scalar>
inline std::size_t PathSolver<Scalar>::choose(std::size_t i, const MusclePaths::Wrap& wrap, std::size_t n) {
  const MusclePaths::Object& object = paths_.objects_[wrap.object];
  std::size_t best = n;
  double least = 1e300;
  std::size_t k = 0;
  while (k < n && (w_.nodes[k].station < 0 || w_.nodes[k].station < wrap.first)) ++k;
  for (; k + 1 < n; ++k) {
    const Node& a = w_.nodes[k];
    const Node& b = w_.nodes[k + 1];
    if (a.station >= 0 && a.station >= wrap.last) break;
    if (b.station > wrap.last) break;
    if (a.wrap >= 0 && a.wrap == b.wrap) continue;
    const bool points = a.station >= 0 && b.station >= 0;
    const WrapResult<Scalar>* r = &w_.fresh;
    if (points && !wrap.spans.empty()) {
      const int s = wrap.spans[a.station - wrap.first];
      if (s < 0) continue;
      if (w_.span_known[s]) {
        r = &w_.span[s];
      } else {
        wrap_between(object, wrap.object, wrap, false, a.x, b.x, w_.fresh);
      }
    } else {
      // Only the segment that an object was found on lets go of it: here it counts fully.
      wrap_between(object, wrap.object, wrap, false, a.x, b.x, w_.fresh, &w_.memory[i]);
    }
    if (!r->wrapped()) continue;
    const double longer = value_of(r->length) - value_of(Vector(b.x - a.x)).norm();
    if (r->meets || longer < least) {
      if (r == &w_.fresh) {
        w_.result_solved[i] = w_.fresh;
        r = &w_.result_solved[i];
      }
      w_.result[i] = r;
      best = k;
      least = longer;
    }
    if (r->meets) break;
  }
  return best;
}

template <typename Scalar>
inline void PathSolver<Scalar>::insert(const Path& path, std::size_t i, std::size_t at, std::size_t& n) {
  for (std::size_t k = n; k-- > at + 1;) w_.nodes[k + 2] = w_.nodes[k];
  const int link = paths_.objects_[path.wraps[i].object].link;
  for (std::size_t j = 0; j < 2; ++j) {
    Node& node = w_.nodes[at + 1 + j];
    node.x = j == 0 ? w_.result[i]->r1 : w_.result[i]->r2;
    node.link = link;
    node.point = -1;
    node.station = -1;
    node.wrap = static_cast<int>(i);
  }
  n += 2;
}

}  // namespace veridyn::muscle
