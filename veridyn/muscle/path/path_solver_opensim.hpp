#pragma once

#include <cmath>
#include <utility>

#include "veridyn/muscle/path/path_solver.hpp"
#include "veridyn/muscle/path/wrap_opensim.hpp"

/// Paths as OpenSim makes them.
namespace veridyn::muscle {

template <typename Scalar>
inline WrapResult<Scalar> PathSolver<Scalar>::as_opensim(const MusclePaths::Object& object,
                                                         const MusclePaths::Wrap& wrap, bool single, const Vector& p,
                                                         const Vector& q) {
  WrapResult<Scalar> r;
  const OpenSimWrap o = wrap_as_opensim(object.description, wrap.method, single, values_of(p), values_of(q));
  if (o.action == OpenSimWrapAction::kInside) r.status = WrapStatus::kInside;
  if (!o.wraps()) return r;
  r.status = WrapStatus::kWrapped;
  r.meets = o.action == OpenSimWrapAction::kMandatory;
  r.r1 = o.r1.cast<Scalar>();
  r.r2 = o.r2.cast<Scalar>();
  r.surface_length = Scalar(o.surface_length);
  r.direction1 = (r.r1 - p).normalized();
  r.direction2 = (q - r.r2).normalized();
  r.gradient_p = -r.direction1;
  r.gradient_q = r.direction2;
  r.length = (r.r1 - p).norm() + r.surface_length + (q - r.r2).norm();
  return r;
}

template <typename Scalar>
inline std::size_t PathSolver<Scalar>::solve_as_opensim(const Path& path, std::size_t n) {
  double last = 1e300;
  std::size_t order[2] = {0, 1};
  for (int pass = 0; pass < 8; ++pass) {
    WrapStatus status[2] = {WrapStatus::kStraight, WrapStatus::kStraight};
    for (std::size_t slot = 0; slot < path.wraps.size(); ++slot) {
      const std::size_t i = slot < 2 ? order[slot] : slot;
      remove(static_cast<int>(i), n);
      const std::size_t at = choose(i, path.wraps[i], n);
      if (at < n) insert(path, i, at, n);
      if (slot < 2 && at == n && w_.first_segment[i] < 0) status[slot] = inside_somewhere(path, i, n);
      if (slot < 2 && at < n) status[slot] = WrapStatus::kWrapped;
    }
    const double length = muscle::value_of(measure<false>(path, n, Scalar(1.0)));
    if (std::abs(length - last) < 0.0005) break;
    last = length;
    if (pass == 0 && status[0] == WrapStatus::kStraight && status[1] == WrapStatus::kInside) {
      std::swap(order[0], order[1]);
      remove(0, n);
    }
  }
  return n;
}

template <typename Scalar>
inline WrapStatus PathSolver<Scalar>::inside_somewhere(const Path& path, std::size_t i, std::size_t n) {
  const MusclePaths::Wrap& wrap = path.wraps[i];
  const MusclePaths::Object& object = paths_.objects_[wrap.object];
  WrapStatus status = WrapStatus::kStraight;
  for (std::size_t k = 0; k + 1 < n; ++k) {
    if (w_.nodes[k].wrap >= 0 && w_.nodes[k].wrap == w_.nodes[k + 1].wrap) continue;
    wrap_between(object, wrap.object, wrap, false, w_.nodes[k].x, w_.nodes[k + 1].x, w_.fresh);
    status = w_.fresh.status;
  }
  return status;
}

}  // namespace veridyn::muscle
