#include "veridyn/muscle/simulation/computed_muscle_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/dynamics/coordinate_forces.hpp"
#include "veridyn/muscle/simulation/assembly.hpp"
#include "veridyn/muscle/simulation/loop_directions.hpp"
#include "veridyn/muscle/simulation/muscle_window.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"
#include "veridyn/muscle/simulation/system_stepper.hpp"
#include "veridyn/numerics/separable_qp.hpp"

namespace veridyn::muscle {
namespace {

/// The desired motion of the free coordinates, in their order.
std::vector<numerics::PiecewisePolynomial> desired_motion(const MusculoskeletalSystem& system, const Motion& motion) {
  std::vector<numerics::PiecewisePolynomial> splines;
  for (const int c : system.reduction().free()) {
    const auto& spline = motion.coordinate[c];
    if (!spline) {
      throw InputError(system.model().name,
                       fmt::format("coordinate '{}' is free but not in the motion to follow; lock it or give it",
                                   system.model().coordinates[c].name));
    }
    splines.push_back(*spline);
  }
  return splines;
}

/// View of a system that is controlled, which must outlive it.
class Controller {
 public:
  Controller(const MusculoskeletalSystem& system, const Motion& motion, const ControlOptions& options)
      : system_(system),
        desired_(desired_motion(system, motion)),
        options_(options),
        external_(motion.external),
        evaluator_(system),
        ahead_(system),
        window_(system.muscles()),
        stepper_(system, {.tolerance = options.accuracy, .smallest_step = 1e-12 * (options.end - options.begin)}),
        loops_(system),
        muscles_(system.muscles().size()),
        required_(signed_index(desired_.size())),
        controls_(required_.size(), signed_index(muscles_) + required_.size()),
        qp_(required_.size(), controls_.cols()),
        low_(muscles_, options.min_control),
        high_(muscles_, options.max_control),
        excitation_(muscles_),
        force_low_(muscles_),
        force_high_(muscles_),
        force_(muscles_),
        optimal_(muscles_),
        activation_(muscles_),
        fiber_(muscles_),
        demand_(desired_.size()),
        planned_speed_(desired_.size()),
        z_(desired_.size()),
        zdot_(desired_.size()),
        zddot_(desired_.size()),
        moment_(system.coordinates()),
        qddot_(system.coordinates()),
        reserve_(system.coordinates()) {
    for (auto& node : nodes_) node.resize(muscles_);
    // Reserves that the options leave out cost so much that they carry only what the muscles cannot.
    constexpr double kCostlyReserve = 1e-3;
    for (const int c : system.reduction().free()) {
      const double force = options.reserve_forces.empty() ? options.reserve_force : options.reserve_forces[c];
      reserve_optimal_.push_back(force > 0.0 ? force : kCostlyReserve);
      reserve_limit_.push_back(std::max(force, 0.1));
    }
    for (std::size_t m = 0; m < muscles_; ++m) {
      low_[m] = std::max(options.min_control, system.muscles().settings(m).min_control);
      high_[m] = std::min(options.max_control, system.muscles().settings(m).max_control);
    }
  }

  ControlResult run(const StartState& pose, Progress& progress);

 private:
  /// Inverse dynamics of the accelerations zddot_ of the motion set.
  void update_moments() {
    const ExpandedState<double>& s = ahead_.dynamics().state();
    for (std::size_t c = 0; c < qddot_.size(); ++c) {
      const int root = system_.reduction().free_root(static_cast<int>(c));
      qddot_[c] = s.bias(c) + (root >= 0 ? s.slope(c) * zddot_[root] : 0.0);
    }
    ahead_.dynamics().dynamics().inverse_dynamics(qddot_.data(), nullptr, moment_.data());
  }

  /// Changes zddot_ to the nearest accelerations that keep the loops closed; after `update_moments`.
  void keep_loops_closed() {
    loops_.set_pose(ahead_.dynamics());
    Eigen::Map<Eigen::VectorXd>(zddot_.data(), std::ssize(zddot_)) += loops_.acceleration_shortfall(ahead_.dynamics());
    update_moments();
  }

  /// Moments that the accelerations zddot_ need at the state (z_, zdot_), less those of limits and of the surroundings
  /// at `time`; moment arms. Both along the motions that loops allow.
  void update_required_moments(double time) {
    ahead_.set_motion(z_.data(), zdot_.data());
    const ExpandedState<double>& s = ahead_.dynamics().state();
    const CoordinateReduction& reduction = system_.reduction();
    update_moments();
    if (loops_.any()) keep_loops_closed();
    std::fill(reserve_.begin(), reserve_.end(), 0.0);
    ahead_.add_passive_forces(reserve_.data());
    ahead_.add_external_forces(external_.get(), time, reserve_.data());
    required_.setZero();
    controls_.setZero();
    for (std::size_t c = 0; c < moment_.size(); ++c) {
      const int root = reduction.free_root(static_cast<int>(c));
      if (root >= 0) required_(root) += s.slope(c) * (moment_[c] - reserve_[c]);
    }
    const auto pairs = system_.pairs();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const int root = reduction.free_root(pairs[i].coordinate);
      if (root >= 0) controls_(root, pairs[i].muscle) -= s.slope(pairs[i].coordinate) * ahead_.path_gradient()[i];
    }
    controls_.rightCols(required_.size()).setIdentity();
    if (!loops_.any()) {
      qp_.A = controls_;
      qp_.b = required_;
      return;
    }
    const Eigen::MatrixXd& along = loops_.directions();
    if (qp_.b.size() != along.cols()) qp_ = numerics::SeparableQp(along.cols(), controls_.cols());
    qp_.A.noalias() = along.transpose() * controls_;
    qp_.b.noalias() = along.transpose() * required_;
  }

  /// min sum (F/F_opt)^2 + sum (reserve/optimal)^2 with the forces between force_low_ and force_high_. Reserves act on
  /// the free coordinates. Writes force_ and reserve_.
  void distribute_forces() {
    for (std::size_t m = 0; m < muscles_; ++m) {
      const RigidTendonForces rigid =
          system_.muscles().rigid_forces(m, 1.0, ahead_.path_length()[m], ahead_.path_speed()[m]);
      const double least = 0.01 * system_.muscles().max_isometric_force(m);
      optimal_[m] = std::max(rigid.active, least);
      qp_.weight(m) = 2.0 / (optimal_[m] * optimal_[m]);
      qp_.low(m) = std::min(force_low_[m], force_high_[m]);
      qp_.high(m) = std::max(force_low_[m], force_high_[m]);
    }
    for (std::size_t f = 0; f < desired_.size(); ++f) {
      const auto i = static_cast<Eigen::Index>(muscles_ + f);
      qp_.weight(i) = 2.0 / (reserve_optimal_[f] * reserve_optimal_[f]);
    }
    static_cast<void>(qp_.solve());
    for (std::size_t m = 0; m < muscles_; ++m) force_[m] = qp_.x()(m);
    std::fill(reserve_.begin(), reserve_.end(), 0.0);
    for (std::size_t f = 0; f < desired_.size(); ++f) {
      reserve_[system_.reduction().free()[f]] = qp_.x()(muscles_ + f);
    }
  }

  /// Whether a reserve gives more than its force.
  [[nodiscard]] bool overloaded() const {
    for (std::size_t f = 0; f < desired_.size(); ++f)
      if (std::abs(reserve_[system_.reduction().free()[f]]) > reserve_limit_[f]) return true;
    return false;
  }

  void start_muscles(const Assembly& closed, double* x);
  [[nodiscard]] bool plan_window(double t, double end, const double* x);

  const MusculoskeletalSystem& system_;
  std::vector<numerics::PiecewisePolynomial> desired_;  ///< by free coordinate
  ControlOptions options_;
  std::shared_ptr<const ExternalLoads> external_;
  SystemEvaluator<double> evaluator_, ahead_;
  MuscleWindow window_;
  SystemStepper stepper_;
  LoopDirections loops_;
  std::size_t muscles_;
  /// Forces that the accelerations need, and what unit forces of muscles and reserves do, by free coordinate.
  Eigen::VectorXd required_;
  Eigen::MatrixXd controls_;
  numerics::SeparableQp qp_;
  /// By free coordinate: force at control 1, and what more than that counts as overloaded [N m or N].
  std::vector<double> reserve_optimal_, reserve_limit_;
  std::vector<double> low_, high_, excitation_, force_low_, force_high_, force_, optimal_, activation_, fiber_;
  std::vector<double> demand_, planned_speed_;  ///< accelerations of the last window's end, speeds it should have left
  std::vector<double> z_, zdot_, zddot_, moment_, qddot_, reserve_;
  std::array<std::vector<double>, MuscleWindow::kNodes> nodes_;
};

/// Muscles in equilibrium at the desired start, at activations that produce the desired moments together.
void Controller::start_muscles(const Assembly& closed, double* x) {
  for (std::size_t f = 0; f < desired_.size(); ++f) {
    const int c = system_.reduction().free()[f];
    x[f] = z_[f] = closed.q(c);
    x[desired_.size() + f] = zdot_[f] = planned_speed_[f] = closed.qdot(c);
    zddot_[f] = desired_[f].evaluate(options_.begin).curvature;
  }
  update_required_moments(options_.begin);
  demand_ = zddot_;
  const auto force_at = [&](std::span<const double> activation, std::span<double> force) {
    std::vector<double> fibers(muscles_);
    system_.muscles().equilibrium(activation, ahead_.path_length(), fibers);
    system_.muscles().tendon_forces({activation, activation, fibers, ahead_.path_length(), ahead_.path_speed()}, force);
  };
  force_at(low_, force_low_);
  force_at(high_, force_high_);
  distribute_forces();
  // Bisection: simple rather than fast, because it is done once.
  std::vector<double> a = low_, b = high_, middle(muscles_), reached(muscles_);
  for (int i = 0; i < 40; ++i) {
    for (std::size_t m = 0; m < muscles_; ++m) middle[m] = 0.5 * (a[m] + b[m]);
    force_at(middle, reached);
    for (std::size_t m = 0; m < muscles_; ++m) (reached[m] < force_[m] ? a[m] : b[m]) = middle[m];
  }
  for (std::size_t m = 0; m < muscles_; ++m) middle[m] = force_high_[m] - force_low_[m] < 1.0 ? low_[m] : middle[m];
  evaluator_.set_motion(x, x + desired_.size());
  evaluator_.start_muscles(middle.data(), x);
  excitation_ = middle;
}

/// Excitations and reserves of the window from t to `end`.
bool Controller::plan_window(double t, double end, const double* x) {
  const std::size_t n = desired_.size();
  const double* speed = x + n;
  // Path lengths along the desired motion, shifted by the present error and its rate.
  for (std::size_t k = 0; k < MuscleWindow::kNodes; ++k) {
    const double s = static_cast<double>(k) / static_cast<double>(MuscleWindow::kNodes - 1) * (end - t);
    for (std::size_t f = 0; f < n; ++f) {
      const numerics::FunctionValue<double> now = desired_[f].evaluate(t), then = desired_[f].evaluate(t + s);
      z_[f] = then.value + (x[f] - now.value) + s * (speed[f] - now.slope);
      zdot_[f] = then.slope + (speed[f] - now.slope);
      // What the last window fell short of in speed is made up in this one.
      const double shortfall = (planned_speed_[f] - speed[f]) / (end - t);
      zddot_[f] = then.curvature + options_.kv * (now.slope - speed[f]) + options_.kp * (now.value - x[f]) + shortfall;
    }
    if (k + 1 < MuscleWindow::kNodes) {
      ahead_.set_motion(z_.data(), zdot_.data());
    } else {
      update_required_moments(end);  // the last node: the window's end
    }
    std::copy(ahead_.path_length().begin(), ahead_.path_length().end(), nodes_[k].begin());
  }
  for (std::size_t f = 0; f < n; ++f) {
    planned_speed_[f] = speed[f] + 0.5 * (end - t) * (demand_[f] + zddot_[f]);
    demand_[f] = zddot_[f];
  }
  const StateLayout& layout = system_.layout();
  for (std::size_t m = 0; m < muscles_; ++m) {
    activation_[m] = layout.activation[m] >= 0 ? x[layout.activation[m]] : excitation_[m];
    fiber_[m] = layout.fiber_length[m] >= 0 ? x[layout.fiber_length[m]] : 0.0;
  }
  window_.set_paths(end - t, nodes_);
  window_.set_states(activation_, fiber_);
  if (!window_.end_forces(low_, options_.accuracy, force_low_) ||
      !window_.end_forces(high_, options_.accuracy, force_high_))
    return false;
  distribute_forces();
  return window_.find_excitations(low_, high_, force_low_, force_high_, force_, options_.accuracy, excitation_);
}

ControlResult Controller::run(const StartState& pose, Progress& progress) {
  ControlResult result;
  result.start = pose;
  evaluator_.hold(pose.q.data());
  ahead_.hold(pose.q.data());
  const StateLayout& layout = system_.layout();
  std::vector<double> x(layout.size);
  for (std::size_t f = 0; f < desired_.size(); ++f) {
    const numerics::FunctionValue<double> w = desired_[f].evaluate(options_.begin);
    const int c = system_.reduction().free()[f];
    result.start.q(c) = w.value;
    result.start.qdot(c) = w.slope;
  }
  // As a forward simulation closes the loops of this start.
  start_muscles(assemble(system_, result.start.q, result.start.qdot), x.data());
  result.start.activation = Eigen::Map<const Eigen::VectorXd>(excitation_.data(), static_cast<Eigen::Index>(muscles_));

  const auto windows = static_cast<std::size_t>(std::ceil((options_.end - options_.begin) / options_.window - 1e-9));
  std::vector<double> times, excitations, reserves;
  double t = options_.begin;
  for (std::size_t w = 0; w < windows; ++w) {
    const double end = std::min(options_.end, options_.begin + static_cast<double>(w + 1) * options_.window);
    if (!plan_window(t, end, x.data())) {
      result.trajectory.end = MotionEnd::kStepSize;
      result.trajectory.trouble = "the muscles alone could not be integrated over a window";
      break;
    }
    if (overloaded()) result.overloaded.push_back(t);
    times.push_back(t);
    excitations.insert(excitations.end(), excitation_.begin(), excitation_.end());
    reserves.insert(reserves.end(), reserve_.begin(), reserve_.end());
    const auto derivative = [&](double time, double step, double* state, double* rate) {
      return evaluator_.stage(step, state, {excitation_, reserve_, external_.get(), time}, rate);
    };
    stepper_.restart(true);
    if (stepper_.advance(derivative, t, x.data(), end, [](double, double) { return true; }) !=
        numerics::IntegrationEnd::kReached) {
      break;
    }
    if (!progress.update(static_cast<double>(w + 1) / static_cast<double>(windows))) {
      result.trajectory.end = MotionEnd::kInterrupted;
      result.trajectory.end_time = t;
      return result;
    }
  }
  result.controls.excitation = ControlSignals(times, std::move(excitations), muscles_, Interpolation::kHold);
  result.controls.external = external_;
  result.controls.reserve =
      ControlSignals(std::move(times), std::move(reserves), system_.coordinates(), Interpolation::kHold);
  return result;
}

void check(const MusculoskeletalSystem& system, const ControlOptions& o) {
  const auto require = [&](bool holds, const char* what) {
    if (!holds) throw InputError(system.model().name, fmt::format("computed muscle control: {}", what));
  };
  require(o.end > o.begin, "the end must come after the beginning");
  require(o.window > 0.0 && o.window <= o.end - o.begin, "the window must be > 0 and within the motion");
  require(o.kp >= 0.0 && o.kv >= 0.0, "gains must not be negative");
  require(o.min_control >= 0.0 && o.min_control < o.max_control && o.max_control <= 1.0,
          "0 <= min_control < max_control <= 1 is required");
  require(o.reserve_force >= 0.0, "the reserve's optimal force must not be negative");
  require(o.reserve_forces.empty() || o.reserve_forces.size() == system.coordinates(),
          "reserve forces must be as many as coordinates");
  for (const double force : o.reserve_forces) require(force >= 0.0, "a reserve's optimal force must not be negative");
  require(system.muscles().size() > 0, "the model has no muscles");
}

}  // namespace

double ControlResult::tracking_error(int coordinate) const {
  return (trajectory.q.col(coordinate) - desired.col(coordinate)).cwiseAbs().maxCoeff();
}

ControlResult computed_muscle_control(const MusculoskeletalSystem& system, const Motion& motion,
                                      const ControlOptions& options, Progress& progress) {
  check(system, options);
  StartState pose = default_start(system.model());
  for (const int c : system.reduction().driven()) {
    const auto& spline = motion.coordinate[c];
    if (spline) pose.q(c) = spline->evaluate(options.begin).value;
  }
  ControlResult result = Controller(system, motion, options).run(pose, progress);
  if (result.trajectory.end == MotionEnd::kInterrupted) return result;
  // The result is the replay of what was found: what a forward simulation of the same controls gives.
  Progress quiet;
  const ForwardOptions forward{
      .begin = options.begin, .end = options.end, .rate_Hz = options.rate_Hz, .accuracy = options.accuracy};
  const MotionEnd end = result.trajectory.end;
  const std::string trouble = result.trajectory.trouble;
  result.trajectory = simulate_forward(system, result.start, result.controls, forward, quiet);
  if (end != MotionEnd::kCompleted) {
    result.trajectory.end = end;
    result.trajectory.trouble = trouble;
  }
  result.desired = result.trajectory.q;
  for (const int c : system.reduction().free()) {
    for (std::size_t i = 0; i < result.trajectory.time.size(); ++i) {
      result.desired(i, c) = motion.coordinate[c]->evaluate(result.trajectory.time[i]).value;
    }
  }
  return result;
}

}  // namespace veridyn::muscle
