#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "veridyn/muscle/dynamics/body_forces.hpp"
#include "veridyn/muscle/dynamics/coordinate_forces.hpp"
#include "veridyn/muscle/dynamics/expression_forces.hpp"
#include "veridyn/muscle/path/muscle_path.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"

namespace veridyn::muscle {

/// Scratch memory of `PassiveForces`, used by one thread.
template <typename Scalar>
struct PassiveWorkspace {
  std::optional<PathWorkspace<Scalar>> paths;
  ExpressionForces expressions;  ///< a thread's own copy
};

/// Forces of a model that follow from its motion alone and act on more than a coordinate: between bodies
/// (`dynamics/body_forces.hpp`), along paths (path springs, ligaments), and by formulas
/// (`dynamics/expression_forces.hpp`). Those of single coordinates are in `dynamics/coordinate_forces.hpp`. Immutable;
/// used by many threads at once.
class PassiveForces {
 public:
  PassiveForces(const Model& model, const Mechanism& mechanism);

  [[nodiscard]] bool empty() const { return bodies_.empty() && expressions_.empty() && !paths_; }
  template <typename Scalar>
  [[nodiscard]] PassiveWorkspace<Scalar> workspace() const {
    PassiveWorkspace<Scalar> made;
    if (paths_) made.paths.emplace(*paths_);
    made.expressions = expressions_;
    return made;
  }

  /// Adds the forces themselves, by link, but those along paths by functions of coordinates. Allocates.
  void add_to_links(const Mechanism& mechanism, const Kinematics<double>& kinematics, const double* q,
                    const double* qdot, std::span<SpatialVector<double>> by_link) const;

  /// Adds their generalised forces (by coordinate) in the state of `kinematics`, whose velocities are set. Does not
  /// allocate or throw.
  template <typename Scalar>
  void add(const Mechanism& mechanism, const Kinematics<Scalar>& kinematics, const Scalar* q, const Scalar* qdot,
           PassiveWorkspace<Scalar>& workspace, Scalar* tau) const {
    if (!bodies_.empty()) add_body_forces(bodies_, mechanism, kinematics, tau);
    if (!expressions_.empty()) {
      add_coordinate_expressions(workspace.expressions, q, qdot, tau);
      add_body_expressions(workspace.expressions, mechanism, kinematics, tau);
    }
    if (!paths_) return;
    PathWorkspace<Scalar>& w = *workspace.paths;
    paths_->evaluate(kinematics, q, w);
    for (int m = 0; m < paths_->muscles(); ++m) {
      Scalar speed(0.0);
      for (std::size_t k = paths_->first_pair(m); k < paths_->end_pair(m); ++k)
        speed += w.gradient[k] * qdot[paths_->pairs()[k].coordinate];
      const Scalar tension = passive_tension(laws_[m], w.length[m], speed);
      for (std::size_t k = paths_->first_pair(m); k < paths_->end_pair(m); ++k)
        tau[paths_->pairs()[k].coordinate] -= tension * w.gradient[k];
    }
  }

 private:
  BodyForces bodies_;
  ExpressionForces expressions_;
  std::vector<PassivePathLaw> laws_;
  std::shared_ptr<const MusclePaths> paths_;
};

}  // namespace veridyn::muscle
