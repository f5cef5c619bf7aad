#pragma once

#include "veridyn/muscle/path/path_solver.hpp"
#include "veridyn/muscle/path/path_solver_length.hpp"
#include "veridyn/muscle/path/path_solver_opensim.hpp"
#include "veridyn/muscle/path/path_solver_straight.hpp"
#include "veridyn/muscle/path/path_solver_wrapping.hpp"

/// Definitions of the templates of `MusclePaths` and `PathWorkspace`. The library compiles them for double and
/// `SimulationJet`; include this only for another scalar.
namespace veridyn::muscle {

template <typename Scalar>
PathWorkspace<Scalar>::PathWorkspace(const MusclePaths& paths)
    : length(paths.muscles_.size()),
      gradient(paths.pairs_.size()),
      flag(paths.muscles_.size(), PathFlag::kFine),
      position(paths.points_.size()),
      moving_slope(3 * paths.moving_.size()),
      segment_length(paths.segments_.size()),
      term(paths.terms_.size()),
      local_column(paths.most_pair_coordinates_),
      object(paths.objects_.size()),
      span(paths.spans_.size()),
      span_known(paths.spans_.size(), 0),
      stations(paths.most_stations_),
      nodes(paths.most_stations_ + 2 * paths.most_wraps_),
      other_nodes(nodes.size()),
      result(paths.most_wraps_),
      other_result(paths.most_wraps_),
      result_solved(paths.most_wraps_),
      other_result_solved(paths.most_wraps_),
      first(paths.most_wraps_),
      first_solved(paths.most_wraps_),
      first_segment(paths.most_wraps_),
      before(2 * paths.most_wraps_),
      start(2 * paths.most_wraps_),
      memory(paths.most_wraps_) {
  for (std::size_t i = 0; i < paths.points_.size(); ++i)
    position[i] = paths.points_[i].location.template cast<Scalar>();
}

template <typename Scalar>
void MusclePaths::lengths(const Kinematics<Scalar>& kinematics, const Scalar* q,
                          PathWorkspace<Scalar>& workspace) const {
  PathSolver<Scalar>(*this, kinematics, q, workspace, PathPlaces::kNeeded).template all<false>();
}

template <typename Scalar>
void MusclePaths::evaluate(const Kinematics<Scalar>& kinematics, const Scalar* q,
                           PathWorkspace<Scalar>& workspace) const {
  PathSolver<Scalar>(*this, kinematics, q, workspace, PathPlaces::kNeeded).template all<true>();
}

template <typename Scalar>
void MusclePaths::evaluate(const Kinematics<Scalar>& kinematics, const Scalar* q, PathWorkspace<Scalar>& workspace,
                           std::span<const std::uint8_t> skip) const {
  PathSolver<Scalar>(*this, kinematics, q, workspace, PathPlaces::kNeeded).template all<true>(skip);
}

template <typename Scalar>
void MusclePaths::speeds(const PathWorkspace<Scalar>& workspace, const Scalar* qdot, Scalar* speeds) const {
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    Scalar speed(0.0);
    for (std::size_t k = muscles_[m].pairs[0]; k < muscles_[m].pairs[1]; ++k)
      speed += workspace.gradient[k] * qdot[pairs_[k].coordinate];
    speeds[m] = speed;
  }
}

}  // namespace veridyn::muscle
