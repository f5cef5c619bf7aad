#include "veridyn/muscle/simulation/motion_analysis.hpp"

#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/dynamics/coordinate_forces.hpp"
#include "veridyn/muscle/simulation/loop_directions.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

/// All coordinates at an instant.
struct Instant {
  Eigen::VectorXd q, qdot, qddot;
};

/// Coordinates without a motion rest at `rest`; coupled ones follow, whatever the motion says of them.
Instant instant_of(const Motion& motion, const Eigen::VectorXd& rest, const CoordinateReduction& reduction,
                   double time) {
  Instant now{rest, Eigen::VectorXd::Zero(rest.size()), Eigen::VectorXd::Zero(rest.size())};
  for (Eigen::Index c = 0; c < rest.size(); ++c) {
    const auto& spline = motion.coordinate[c];
    if (!spline) continue;
    const numerics::FunctionValue<double> value = spline->evaluate(time);
    now.q(c) = value.value;
    now.qdot(c) = value.slope;
    now.qddot(c) = value.curvature;
  }
  for (const CoordinateReduction::Coupler& coupler : reduction.couplers()) {
    const numerics::FunctionValue<double> f = coupler.function.evaluate(now.q(coupler.independent));
    const double speed = now.qdot(coupler.independent);
    now.q(coupler.dependent) = f.value;
    now.qdot(coupler.dependent) = f.slope * speed;
    now.qddot(coupler.dependent) = f.slope * now.qddot(coupler.independent) + f.curvature * speed * speed;
  }
  return now;
}

MotionAnalysis empty_analysis(const MusculoskeletalSystem& system, const std::vector<double>& time, bool loaded) {
  MotionAnalysis a;
  a.time = time;
  const auto rows = signed_index(time.size());
  for (auto* m : {&a.q, &a.qdot, &a.qddot, &a.moment}) m->setZero(rows, system.coordinates());
  if (loaded) a.external.setZero(rows, system.coordinates());
  for (auto* m : {&a.path_length, &a.path_speed}) m->setZero(rows, system.muscles().size());
  return a;
}

/// View of a system: what the closed loops of its model carry.
class LoopShare {
 public:
  explicit LoopShare(const MusculoskeletalSystem& system) : system_(system), motions_(system) {}

  [[nodiscard]] bool any() const { return motions_.any(); }

  /// Looks at the loops of a pose. The evaluator is left at it, with the speeds of free coordinates only.
  void set_pose(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot, double time, SystemEvaluator<double>& evaluator,
                MotionAnalysis::LoopGap& gap) {
    evaluator.set_pose(q.data(), qdot.data());
    loops_ = &motions_.set_pose(evaluator.dynamics());
    for (int r = 0; r < loops_->rows(); ++r) {
      const double error = std::abs(loops_->row(r).error);
      if (!gap.constraint.empty() && error <= gap.error) continue;
      gap = {loops_->loops().of_row(r).text, error, time};
    }
  }

  /// Orthonormal: the motions of the free coordinates that the loops allow.
  [[nodiscard]] const Eigen::MatrixXd& directions() const { return motions_.directions(); }

  /// Takes what the loops carry off the forces that a motion needs.
  template <typename Row>
  void take_off(const Eigen::VectorXd& slope, const Kinematics<double>& kinematics, Row&& moment) {
    Eigen::VectorXd required = Eigen::VectorXd::Zero(motions_.jacobian().cols()),
                    carried = Eigen::VectorXd::Zero(slope.size());
    for (Eigen::Index c = 0; c < slope.size(); ++c) {
      const int root = system_.reduction().free_root(static_cast<int>(c));
      if (root >= 0) required(root) += slope(c) * moment(c);
    }
    motions_.carry(required, *loops_);
    loops_->add_generalized_forces(kinematics, carried.data());
    moment -= carried.transpose();
  }

 private:
  const MusculoskeletalSystem& system_;
  LoopDirections motions_;
  LoopSolver<double>* loops_ = nullptr;
};

/// Sets the evaluator to an instant and writes what inverse dynamics finds there into a row.
void analyse(const Instant& now, Eigen::Index row, const ExternalLoads* external, SystemEvaluator<double>& evaluator,
             LoopShare& loops, const Eigen::VectorXd& slope, MotionAnalysis& a) {
  if (loops.any()) loops.set_pose(now.q, now.qdot, a.time[row], evaluator, a.loop_gap);
  evaluator.set_all(now.q.data(), now.qdot.data());
  a.q.row(row) = now.q;
  a.qdot.row(row) = now.qdot;
  a.qddot.row(row) = now.qddot;
  evaluator.dynamics().dynamics().inverse_dynamics(now.qddot.data(), nullptr, a.moment.row(row).data());
  if (external != nullptr) {
    evaluator.add_external_forces(external, a.time[row], a.external.row(row).data());
    a.moment.row(row) -= a.external.row(row);
  }
  if (loops.any()) loops.take_off(slope, evaluator.dynamics().kinematics(), a.moment.row(row));
  for (Eigen::Index m = 0; m < a.path_length.cols(); ++m) {
    a.path_length(row, m) = evaluator.path_length()[m];
    a.path_speed(row, m) = evaluator.path_speed()[m];
  }
}

}  // namespace

Eigen::VectorXd coupled_slopes(const Eigen::VectorXd& q, const CoordinateReduction& reduction) {
  Eigen::VectorXd slope = Eigen::VectorXd::Ones(q.size());
  for (const CoordinateReduction::Coupler& coupler : reduction.couplers()) {
    slope(coupler.dependent) = coupler.function.evaluate(q(coupler.independent)).slope * slope(coupler.independent);
  }
  return slope;
}

std::vector<double> frame_times(double begin, double end, double rate_Hz) {
  const auto last = static_cast<std::size_t>(std::floor((end - begin) * rate_Hz * (1.0 + 1e-12) + 1e-9));
  std::vector<double> time(last + 1);
  for (std::size_t i = 0; i <= last; ++i) time[i] = begin + static_cast<double>(i) / rate_Hz;
  return time;
}

MotionAnalysis analyse_motion(const MusculoskeletalSystem& system, const Motion& motion, const Eigen::VectorXd& rest,
                              const std::vector<double>& time) {
  MotionAnalysis analysis = empty_analysis(system, time, motion.external != nullptr);
  SystemEvaluator<double> evaluator(system);
  LoopShare loops(system);
  for (std::size_t i = 0; i < time.size(); ++i) {
    const Instant now = instant_of(motion, rest, system.reduction(), time[i]);
    analyse(now, i, motion.external.get(), evaluator, loops, coupled_slopes(now.q, system.reduction()), analysis);
  }
  return analysis;
}

MotionAnalysis optimise_motion(const MusculoskeletalSystem& system, const Motion& motion, const Eigen::VectorXd& rest,
                               const std::vector<double>& time, const StaticOptimizationOptions& options,
                               Progress& progress) {
  MotionAnalysis analysis = empty_analysis(system, time, motion.external != nullptr);
  const auto rows = signed_index(time.size());
  const auto muscles = signed_index(system.muscles().size());
  const std::span<const int> free = system.reduction().free();
  const auto n = signed_index(free.size());
  analysis.activation.setZero(rows, muscles);
  analysis.force.setZero(rows, muscles);
  analysis.reserve.setZero(rows, system.coordinates());
  // Reserves are given by coordinate; the optimiser knows the free ones.
  StaticOptimizationOptions reduced = options;
  reduced.reserve.clear();
  for (const int c : free) {
    if (!options.reserve.empty()) reduced.reserve.push_back(options.reserve[c]);
  }
  StaticOptimizer optimizer(muscle_parameters(system.model()), reduced);
  StaticOptimizationFrame frame;
  SystemEvaluator<double> evaluator(system);
  LoopShare loops(system);
  Eigen::MatrixXd arms(muscles, n);
  Eigen::VectorXd required(n), limits(rest.size());
  for (std::size_t i = 0; i < time.size(); ++i) {
    const Instant now = instant_of(motion, rest, system.reduction(), time[i]);
    const Eigen::VectorXd slope = coupled_slopes(now.q, system.reduction());
    analyse(now, i, motion.external.get(), evaluator, loops, slope, analysis);
    limits.setZero();
    evaluator.add_passive_forces(limits.data());
    required.setZero();
    for (Eigen::Index c = 0; c < rest.size(); ++c) {
      const int root = system.reduction().free_root(static_cast<int>(c));
      if (root >= 0) required(root) += slope(c) * (analysis.moment(i, c) - limits(c));
    }
    arms.setZero();
    const auto pairs = system.pairs();
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const int root = system.reduction().free_root(pairs[k].coordinate);
      if (root >= 0) arms(pairs[k].muscle, root) -= slope(pairs[k].coordinate) * evaluator.path_gradient()[k];
    }
    optimizer.solve(arms, analysis.path_length.row(i).transpose(), analysis.path_speed.row(i).transpose(), required,
                    frame, loops.any() ? &loops.directions() : nullptr);
    analysis.activation.row(i) = frame.activation;
    analysis.force.row(i) = frame.force;
    for (Eigen::Index f = 0; f < n && !reduced.reserve.empty(); ++f) {
      analysis.reserve(i, free[f]) = frame.reserve(f) * reduced.reserve[f];
    }
    if (!frame.usable()) analysis.infeasible.push_back(i);
    if (i % 100 == 99 && !progress.update(static_cast<double>(i + 1) / static_cast<double>(time.size()))) {
      analysis.interrupted = true;
      break;
    }
  }
  return analysis;
}

}  // namespace veridyn::muscle
