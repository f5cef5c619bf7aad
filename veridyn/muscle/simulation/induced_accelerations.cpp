#include "veridyn/muscle/simulation/induced_accelerations.hpp"

#include <algorithm>

#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

/// View of a system: accelerations of single forces in one state after another.
class InducedSolver {
 public:
  explicit InducedSolver(const MusculoskeletalSystem& system)
      : evaluator_(system),
        rest_(system.mechanism()),
        tau_(Eigen::VectorXd::Zero(system.coordinates())),
        none_(system.layout().free),
        with_(none_.size()) {}

  void set_state(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot) {
    evaluator_.set_pose(q.data(), qdot.data());
    tau_.setZero();
    static_cast<void>(evaluator_.dynamics().forward_dynamics(tau_.data(), nullptr, none_.data()));
  }
  SystemEvaluator<double>& evaluator() { return evaluator_; }
  /// Without any force but gravity: what is there in any case.
  [[nodiscard]] const std::vector<double>& without_forces() const { return none_; }

  /// Of generalised forces alone.
  const std::vector<double>& of(const Eigen::VectorXd& tau) {
    static_cast<void>(evaluator_.dynamics().forward_dynamics(tau.data(), nullptr, with_.data()));
    for (std::size_t i = 0; i < with_.size(); ++i) with_[i] -= none_[i];
    return with_;
  }

  /// Gravity's forces: against what inverse dynamics needs at rest.
  Eigen::VectorXd gravity() {
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(tau_.size());
    rest_.set_state(evaluator_.q(), still.data());
    rest_.inverse_dynamics(nullptr, nullptr, tau_.data());
    return -tau_;
  }

 private:
  SystemEvaluator<double> evaluator_;
  Dynamics<double> rest_;
  Eigen::VectorXd tau_;
  std::vector<double> none_, with_;
};

}  // namespace

InducedAccelerations induced_accelerations(const MusculoskeletalSystem& system, const MovedModel& moved) {
  InducedAccelerations induced;
  const Model& model = system.model();
  const std::span<const int> free = system.reduction().free();
  induced.coordinates.assign(free.begin(), free.end());
  const Eigen::Index muscles = moved.tendon_force.cols();
  for (Eigen::Index m = 0; m < muscles; ++m) induced.sources.push_back(model.muscles[m].name());
  induced.sources.insert(induced.sources.end(), {"gravity", "velocity"});
  if (moved.passive) induced.sources.emplace_back("passive");
  if (moved.reserve.size() > 0) induced.sources.emplace_back("reserves");
  if (moved.external != nullptr) induced.sources.emplace_back("external");
  induced.part.assign(free.size(), estimation::RowMatrix::Zero(moved.q.rows(), induced.sources.size()));
  InducedSolver solver(system);
  SystemEvaluator<double>& evaluator = solver.evaluator();
  const Eigen::Index n = moved.q.cols();
  for (Eigen::Index row = 0; row < moved.q.rows(); ++row) {
    solver.set_state(moved.q.row(row), moved.qdot.row(row));
    Eigen::Index source = 0;
    const auto store = [&](const std::vector<double>& accelerations) {
      for (std::size_t i = 0; i < free.size(); ++i) induced.part[i](row, source) = accelerations[i];
      ++source;
    };
    const auto pairs = system.pairs();
    for (Eigen::Index m = 0; m < muscles; ++m) {
      Eigen::VectorXd tau = Eigen::VectorXd::Zero(n);
      for (std::size_t k = 0; k < pairs.size(); ++k)
        if (pairs[k].muscle == m) tau(pairs[k].coordinate) -= moved.tendon_force(row, m) * evaluator.path_gradient()[k];
      store(solver.of(tau));
    }
    store(solver.of(solver.gravity()));
    std::vector<double> velocity = solver.without_forces();
    for (std::size_t i = 0; i < free.size(); ++i) velocity[i] -= induced.part[i](row, source - 1);
    store(velocity);
    if (moved.passive) {
      Eigen::VectorXd tau = Eigen::VectorXd::Zero(n);
      evaluator.add_passive_forces(tau.data());
      store(solver.of(tau));
    }
    if (moved.reserve.size() > 0) store(solver.of(moved.reserve.row(row).transpose()));
    if (moved.external != nullptr) {
      Eigen::VectorXd tau = Eigen::VectorXd::Zero(n);
      evaluator.add_external_forces(moved.external, moved.time[row], tau.data());
      store(solver.of(tau));
    }
  }
  return induced;
}

}  // namespace veridyn::muscle
