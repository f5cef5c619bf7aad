#include "veridyn/muscle/simulation/joint_reactions.hpp"

#include <algorithm>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/dynamics/external_forces.hpp"
#include "veridyn/muscle/simulation/loop_directions.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

/// The system's model with a locked hinge in the place of each weld, so that its bodies are links of their own; its
/// coordinates come after the others.
Model with_hinges(Model model) {
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    Joint& joint = model.joints[j];
    if (!joint.coordinates.empty()) continue;
    const int added = static_cast<int>(model.coordinates.size());
    TransformAxis& axis = joint.rotation[0];
    axis.function = numerics::PiecewisePolynomial::linear(1.0, axis.function.evaluate(0.0).value);
    axis.coordinate = added;
    joint.coordinates = {added};
    model.coordinates.push_back({.name = joint.name + "_weld", .joint = static_cast<int>(j), .locked = true});
  }
  return model;
}

SystemOptions as_prepared(const MusculoskeletalSystem& system) {
  SystemOptions options;
  options.paths = system.path_source() == PathSource::kAsOpenSim ? PathSource::kAsOpenSim : PathSource::kExact;
  options.without_unsupported = true;
  return options;
}

/// View of a system and its motion: one instant after another. Accelerations are the system's, reactions those of the
/// same bodies with their welds cut.
class ReactionSolver {
 public:
  ReactionSolver(const MusculoskeletalSystem& system, const MovedModel& moved)
      : system_(system),
        moved_(moved),
        evaluator_(system),
        loops_(system),
        cut_(with_hinges(system.model()), as_prepared(system)),
        dynamics_(cut_.mechanism()),
        paths_(cut_.paths()),
        applied_(cut_.mechanism().links()),
        tau_(cut_.coordinates()),
        zddot_(system.layout().free) {}

  /// Forces of the row on all links; `dynamics().joint_force` holds what joints transmit afterwards.
  void solve(Eigen::Index row) {
    Eigen::VectorXd q = moved_.q.row(row), qdot = moved_.qdot.row(row), qddot;
    if (moved_.qddot.size() > 0) {
      qddot = moved_.qddot.row(row);
      if (!system_.loops().empty()) close_loops(q, qdot, qddot, row);
    } else {
      qddot = accelerations(q, qdot, row);
      q = evaluator_.dynamics().state().q;
      qdot = evaluator_.dynamics().state().qdot;
    }
    for (Eigen::VectorXd* x : {&q, &qdot, &qddot}) {
      const Eigen::Index known = x->size();
      x->conservativeResize(tau_.size());
      x->tail(x->size() - known).setZero();
    }
    dynamics_.set_state(q.data(), qdot.data());
    pull(row, q, qdot);
    dynamics_.inverse_dynamics(qddot.data(), applied_.data(), tau_.data());
  }

  [[nodiscard]] const Dynamics<double>& dynamics() const { return dynamics_; }
  [[nodiscard]] const Mechanism& mechanism() const { return cut_.mechanism(); }

 private:
  /// Sets the pose; tau_ are the generalised forces of a row, by coordinate, but those of loops.
  void set_forces(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot, Eigen::Index row) {
    evaluator_.set_pose(q.data(), qdot.data());
    std::fill(tau_.begin(), tau_.end(), 0.0);
    for (Eigen::Index c = 0; c < moved_.reserve.cols(); ++c) tau_[c] = moved_.reserve(row, c);
    const auto pairs = system_.pairs();
    for (std::size_t k = 0; k < pairs.size() && moved_.tendon_force.size() > 0; ++k)
      tau_[pairs[k].coordinate] -= moved_.tendon_force(row, pairs[k].muscle) * evaluator_.path_gradient()[k];
    if (moved_.passive) evaluator_.add_passive_forces(tau_.data());
    evaluator_.add_external_forces(moved_.external, moved_.time[row], tau_.data());
  }

  Eigen::VectorXd accelerations(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot, Eigen::Index row) {
    set_forces(q, qdot, row);
    static_cast<void>(evaluator_.dynamics().forward_dynamics(tau_.data(), nullptr, zddot_.data()));
    return evaluator_.dynamics().qddot();
  }

  /// Multipliers of the loops with which the forces of a row give its accelerations.
  void close_loops(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot, const Eigen::VectorXd& qddot,
                   Eigen::Index row) {
    set_forces(q, qdot, row);
    Eigen::VectorXd lacking(qddot.size());
    evaluator_.dynamics().dynamics().inverse_dynamics(qddot.data(), nullptr, lacking.data());
    const CoordinateReduction& reduction = system_.reduction();
    Eigen::VectorXd along = Eigen::VectorXd::Zero(signed_index(reduction.free().size()));
    for (Eigen::Index c = 0; c < lacking.size(); ++c) {
      const int root = reduction.free_root(static_cast<int>(c));
      if (root >= 0) along(root) += evaluator_.dynamics().state().slope(c) * (lacking(c) - tau_[c]);
    }
    loops_.carry(along, loops_.set_pose(evaluator_.dynamics()));
  }

  /// All forces on links but those of joints.
  void pull(Eigen::Index row, const Eigen::VectorXd& q, const Eigen::VectorXd& qdot) {
    const Kinematics<double>& kinematics = dynamics_.kinematics();
    std::fill(applied_.begin(), applied_.end(), SpatialVector<double>{});
    if (const LoopSolver<double>* loops = evaluator_.dynamics().loops(); loops != nullptr) {
      for (int r = 0; r < loops->rows(); ++r) {
        const LoopConstraints::Constraint& c = cut_.loops().of_row(r);
        applied_[c.link_2].add_scaled(loops->multiplier(r), loops->row(r).force);
        applied_[c.link_1].add_scaled(-loops->multiplier(r), loops->row(r).force);
      }
    }
    if (moved_.external != nullptr)
      add_external_forces(*moved_.external, moved_.time[row], mechanism(), kinematics, applied_.data());
    if (moved_.passive) cut_.passive().add_to_links(mechanism(), kinematics, q.data(), qdot.data(), applied_);
    for (Eigen::Index m = 0; m < moved_.tendon_force.cols(); ++m)
      cut_.paths().add_tension(kinematics, q.data(), static_cast<int>(m), moved_.tendon_force(row, m), paths_,
                               applied_);
  }

  const MusculoskeletalSystem& system_;
  const MovedModel& moved_;
  SystemEvaluator<double> evaluator_;
  LoopDirections loops_;
  MusculoskeletalSystem cut_;
  Dynamics<double> dynamics_;
  PathWorkspace<double> paths_;
  std::vector<SpatialVector<double>> applied_;
  std::vector<double> tau_, zddot_;
};

Eigen::Matrix3d axes_of(const Joint& joint, const Mechanism& mechanism, const Kinematics<double>& kinematics,
                        ReactionFrame frame) {
  switch (frame) {
    case ReactionFrame::kGround:
      break;
    case ReactionFrame::kParent:
      return body_pose(mechanism, kinematics, joint.parent).rotation * joint.parent_frame.rotation;
    case ReactionFrame::kChild:
      return body_pose(mechanism, kinematics, joint.child).rotation * joint.child_frame.rotation;
  }
  return Eigen::Matrix3d::Identity();
}

}  // namespace

std::vector<std::string> paths_without_place(const MusculoskeletalSystem& system) {
  std::vector<std::string> names;
  for (const Muscle& muscle : system.model().muscles)
    if (muscle.function) names.push_back(muscle.name());
  for (const PassivePath& path : system.model().passive_paths)
    if (path.function) names.push_back(path.name);
  return names;
}

JointReactions joint_reactions(const MusculoskeletalSystem& system, const MovedModel& moved, ReactionFrame frame) {
  const Model& model = system.model();
  JointReactions reactions;
  for (std::size_t j = 0; j < model.joints.size(); ++j) reactions.joints.push_back(static_cast<int>(j));
  const auto rows = moved.q.rows(), columns = 3 * signed_index(reactions.joints.size());
  reactions.force.setZero(rows, columns);
  reactions.moment.setZero(rows, columns);
  ReactionSolver solver(system, moved);
  const Mechanism& mechanism = solver.mechanism();
  for (Eigen::Index row = 0; row < rows; ++row) {
    solver.solve(row);
    const Kinematics<double>& kinematics = solver.dynamics().kinematics();
    for (std::size_t k = 0; k < reactions.joints.size(); ++k) {
      const Joint& joint = model.joints[reactions.joints[k]];
      const SpatialVector<double>& wrench = solver.dynamics().joint_force(mechanism.body(joint.child).link);
      const Eigen::Vector3d origin = body_pose(mechanism, kinematics, joint.child) * joint.child_frame.translation;
      const Eigen::Matrix3d axes = axes_of(joint, mechanism, kinematics, frame);
      const Eigen::Index column = 3 * signed_index(k);
      reactions.force.row(row).segment(column, 3) = axes.transpose() * wrench.linear;
      reactions.moment.row(row).segment(column, 3) = axes.transpose() * (wrench.angular - origin.cross(wrench.linear));
    }
  }
  return reactions;
}

}  // namespace veridyn::muscle
