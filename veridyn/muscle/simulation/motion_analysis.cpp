#include "veridyn/muscle/simulation/motion_analysis.hpp"

#include <cmath>

#include "veridyn/muscle/dynamics/coordinate_forces.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

/// Evaluates a system along a motion.
class Follower {
 public:
  Follower(const MusculoskeletalSystem& system, const Motion& motion, const Eigen::VectorXd& rest)
      : system_(system),
        motion_(motion),
        rest_(rest),
        evaluator_(system),
        q(rest.size()),
        qdot(rest.size()),
        qddot(rest.size()),
        moment(rest.size()) {}

  void go_to(double time) {
    for (Eigen::Index c = 0; c < q.size(); ++c) {
      const auto& spline = motion_.coordinate[static_cast<std::size_t>(c)];
      const numerics::FunctionValue<double> value =
          spline ? spline->evaluate(time) : numerics::FunctionValue<double>{rest_(c), 0.0, 0.0};
      q(c) = value.value;
      qdot(c) = value.slope;
      qddot(c) = value.curvature;
    }
    // What is coupled follows, whatever the file says of it.
    for (const CoordinateReduction::Coupler& coupler : system_.reduction().couplers()) {
      const numerics::FunctionValue<double> f = coupler.function.evaluate(q(coupler.independent));
      q(coupler.dependent) = f.value;
      qdot(coupler.dependent) = f.slope * qdot(coupler.independent);
      qddot(coupler.dependent) =
          f.slope * qddot(coupler.independent) + f.curvature * qdot(coupler.independent) * qdot(coupler.independent);
    }
    evaluator_.set_all(q.data(), qdot.data());
    evaluator_.dynamics().dynamics().inverse_dynamics(qddot.data(), nullptr, moment.data());
  }

  [[nodiscard]] const SystemEvaluator<double>& evaluator() const { return evaluator_; }
  /// dq / d(the free coordinate that this one follows).
  [[nodiscard]] Eigen::VectorXd slopes() const {
    Eigen::VectorXd slope = Eigen::VectorXd::Ones(q.size());
    for (const CoordinateReduction::Coupler& coupler : system_.reduction().couplers()) {
      slope(coupler.dependent) = coupler.function.evaluate(q(coupler.independent)).slope * slope(coupler.independent);
    }
    return slope;
  }

 private:
  const MusculoskeletalSystem& system_;
  const Motion& motion_;
  const Eigen::VectorXd& rest_;
  SystemEvaluator<double> evaluator_;

 public:
  Eigen::VectorXd q, qdot, qddot, moment;
};

MotionAnalysis empty_analysis(const MusculoskeletalSystem& system, const std::vector<double>& time) {
  MotionAnalysis a;
  a.time = time;
  const auto rows = static_cast<Eigen::Index>(time.size());
  for (auto* m : {&a.q, &a.qdot, &a.qddot, &a.moment})
    m->setZero(rows, static_cast<Eigen::Index>(system.coordinates()));
  for (auto* m : {&a.path_length, &a.path_speed}) m->setZero(rows, static_cast<Eigen::Index>(system.muscles().size()));
  return a;
}

void store(const Follower& f, Eigen::Index row, MotionAnalysis& a) {
  a.q.row(row) = f.q;
  a.qdot.row(row) = f.qdot;
  a.qddot.row(row) = f.qddot;
  a.moment.row(row) = f.moment;
  for (Eigen::Index m = 0; m < a.path_length.cols(); ++m) {
    a.path_length(row, m) = f.evaluator().path_length()[static_cast<std::size_t>(m)];
    a.path_speed(row, m) = f.evaluator().path_speed()[static_cast<std::size_t>(m)];
  }
}

}  // namespace

std::vector<double> frame_times(double begin, double end, double rate_Hz) {
  const auto last = static_cast<std::size_t>(std::floor((end - begin) * rate_Hz * (1.0 + 1e-12) + 1e-9));
  std::vector<double> time(last + 1);
  for (std::size_t i = 0; i <= last; ++i) time[i] = begin + static_cast<double>(i) / rate_Hz;
  return time;
}

MotionAnalysis analyse_motion(const MusculoskeletalSystem& system, const Motion& motion, const Eigen::VectorXd& rest,
                              const std::vector<double>& time) {
  MotionAnalysis analysis = empty_analysis(system, time);
  Follower follower(system, motion, rest);
  for (std::size_t i = 0; i < time.size(); ++i) {
    follower.go_to(time[i]);
    store(follower, static_cast<Eigen::Index>(i), analysis);
  }
  return analysis;
}

MotionAnalysis optimise_motion(const MusculoskeletalSystem& system, const Motion& motion, const Eigen::VectorXd& rest,
                               const std::vector<double>& time, const StaticOptimizationOptions& options,
                               Progress& progress) {
  MotionAnalysis analysis = empty_analysis(system, time);
  const auto rows = static_cast<Eigen::Index>(time.size());
  const auto muscles = static_cast<Eigen::Index>(system.muscles().size());
  const std::span<const int> free = system.reduction().free();
  const auto n = static_cast<Eigen::Index>(free.size());
  analysis.activation.setZero(rows, muscles);
  analysis.force.setZero(rows, muscles);
  analysis.reserve.setZero(rows, static_cast<Eigen::Index>(system.coordinates()));
  // Reserves are given by coordinate; the optimiser knows the free ones.
  StaticOptimizationOptions reduced = options;
  reduced.reserve.clear();
  for (const int c : free) {
    if (!options.reserve.empty()) reduced.reserve.push_back(options.reserve[static_cast<std::size_t>(c)]);
  }
  StaticOptimizer optimizer(muscle_parameters(system.model()), reduced);
  StaticOptimizationFrame frame;
  Follower follower(system, motion, rest);
  Eigen::MatrixXd arms(muscles, n);
  Eigen::VectorXd required(n), limits(follower.q.size());
  for (std::size_t i = 0; i < time.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    follower.go_to(time[i]);
    store(follower, row, analysis);
    const Eigen::VectorXd slope = follower.slopes();
    limits.setZero();
    add_limit_forces<double>(system.model().limit_forces, follower.q.data(), follower.qdot.data(), limits.data());
    required.setZero();
    for (Eigen::Index c = 0; c < follower.q.size(); ++c) {
      const int root = system.reduction().free_root(static_cast<int>(c));
      if (root >= 0) required(root) += slope(c) * (follower.moment(c) - limits(c));
    }
    arms.setZero();
    const auto pairs = system.pairs();
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const int root = system.reduction().free_root(pairs[k].coordinate);
      if (root >= 0)
        arms(pairs[k].muscle, root) -= slope(pairs[k].coordinate) * follower.evaluator().path_gradient()[k];
    }
    optimizer.solve(arms, analysis.path_length.row(row).transpose(), analysis.path_speed.row(row).transpose(), required,
                    frame);
    analysis.activation.row(row) = frame.activation;
    analysis.force.row(row) = frame.force;
    for (Eigen::Index f = 0; f < n && !reduced.reserve.empty(); ++f) {
      analysis.reserve(row, free[static_cast<std::size_t>(f)]) =
          frame.reserve(f) * reduced.reserve[static_cast<std::size_t>(f)];
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
