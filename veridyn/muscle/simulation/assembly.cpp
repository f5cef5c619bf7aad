#include "veridyn/muscle/simulation/assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/dynamics/reduced_dynamics.hpp"

namespace veridyn::muscle {
namespace {

/// View of a system: its loops at one pose after another.
class Assembler {
 public:
  Assembler(const MusculoskeletalSystem& system, const Eigen::VectorXd& q, const Eigen::VectorXd& qdot)
      : system_(system),
        dynamics_(system.mechanism(), system.reduction(), &system.loops()),
        driven_(system.reduction().default_motion()),
        rows_(at(system.loops().rows())) {
    const CoordinateReduction& reduction = system.reduction();
    for (std::size_t i = 0; i < driven_.size(); ++i) driven_[i].value = q(reduction.driven()[i]);
    for (const int c : reduction.free()) {
      z_.push_back(q(c));
      zdot_.push_back(qdot(c));
    }
    step_.resize(z_.size());
    wanted_.resize(rows_);
    Y_.resize(rows_ * z_.size());
  }

  Assembly run() {
    double error = close(z_);
    constexpr int kMostSteps = 200;
    constexpr double kClosed = 1e-13;
    for (int i = 0; i < kMostSteps && error > kClosed; ++i) {
      if (!improve(error)) break;
    }
    constexpr double kGood = 1e-9;
    static_cast<void>(close(z_));
    if (!(error < kGood)) refuse();
    check_welds();
    for (std::size_t r = 0; r < rows_; ++r) wanted_[r] = -dynamics_.loops()->row(static_cast<int>(r)).rate;
    find_step();
    for (std::size_t i = 0; i < z_.size(); ++i) zdot_[i] += step_[i];
    static_cast<void>(close(z_));
    const ExpandedState<double>& state = dynamics_.state();
    return {.q = state.q, .qdot = state.qdot, .error = error};
  }

 private:
  /// Sets a pose; returns its largest error.
  double close(const std::vector<double>& z) {
    dynamics_.set_state(z.data(), zdot_.data(), driven_.data());
    const LoopSolver<double>& loops = dynamics_.update_loops();
    double largest = 0.0;
    for (int r = 0; r < loops.rows(); ++r) {
      const double error = std::abs(loops.row(r).error);
      if (!(error <= largest)) largest = error;
    }
    return largest;
  }

  /// The least step that changes the errors by `wanted_`, to first order.
  void find_step() {
    LoopSolver<double>& loops = dynamics_.update_loops();
    const std::size_t n = z_.size();
    for (std::size_t r = 0; r < rows_; ++r)
      std::copy_n(loops.jacobian(static_cast<int>(r)), n, Y_.begin() + static_cast<std::ptrdiff_t>(r * n));
    loops.solve(Y_.data(), wanted_.data());
    std::fill(step_.begin(), step_.end(), 0.0);
    for (std::size_t r = 0; r < rows_; ++r) {
      for (std::size_t i = 0; i < n; ++i) step_[i] += loops.multiplier(static_cast<int>(r)) * Y_[r * n + i];
    }
  }

  /// A step that lessens the errors; false when there is none.
  bool improve(double& error) {
    for (std::size_t r = 0; r < rows_; ++r) wanted_[r] = -dynamics_.loops()->row(static_cast<int>(r)).error;
    find_step();
    constexpr double kLongest = 0.5;
    double longest = 0.0;
    for (const double s : step_) longest = std::max(longest, std::abs(s));
    double factor = longest > kLongest ? kLongest / longest : 1.0;
    std::vector<double> trial(z_.size());
    for (int halving = 0; halving < 30; ++halving, factor *= 0.5) {
      for (std::size_t i = 0; i < z_.size(); ++i) trial[i] = z_[i] + factor * step_[i];
      const double then = close(trial);
      if (!(then < error)) continue;
      z_ = trial;
      error = then;
      return true;
    }
    static_cast<void>(close(z_));
    return false;
  }

  [[noreturn]] void refuse() const {
    const LoopSolver<double>& loops = *dynamics_.loops();
    int worst = 0;
    for (int r = 1; r < loops.rows(); ++r)
      if (!(std::abs(loops.row(r).error) <= std::abs(loops.row(worst).error))) worst = r;
    throw InputError(system_.model().name,
                     fmt::format("no pose near the start closes its loops: {} stays {:.3g} open; start nearer to one",
                                 loops.loops().of_row(worst).text, std::abs(loops.row(worst).error)));
  }

  /// The equations of a weld also hold where one frame is turned by half a turn.
  void check_welds() const {
    for (const LoopConstraints::Constraint& c : system_.loops().constraints()) {
      if (c.kind != LoopKind::kWeld) continue;
      const Kinematics<double>& k = dynamics_.kinematics();
      const Eigen::Matrix3d turned = (k.pose[c.link_1].rotation * c.frame_1.rotation).transpose() *
                                     (k.pose[c.link_2].rotation * c.frame_2.rotation);
      if (turned.diagonal().minCoeff() < 0.5)
        throw InputError(system_.model().name,
                         fmt::format("near the start {} closes only with its frames turned against each other; start "
                                     "nearer to where they agree",
                                     c.text));
    }
  }

  const MusculoskeletalSystem& system_;
  ReducedDynamics<double> dynamics_;
  std::vector<DrivenMotion<double>> driven_;
  std::size_t rows_;
  std::vector<double> z_, zdot_, step_, wanted_, Y_;
};

}  // namespace

Assembly assemble(const MusculoskeletalSystem& system, const Eigen::VectorXd& q, const Eigen::VectorXd& qdot) {
  if (system.loops().empty()) return {.q = q, .qdot = qdot};
  Assembly assembly = Assembler(system, q, qdot).run();
  for (const int c : system.reduction().free()) {
    const double by = std::abs(assembly.q(c) - q(c));
    if (!(by > assembly.by)) continue;
    assembly.by = by;
    assembly.moved = c;
  }
  return assembly;
}

std::string assembly_text(const MusculoskeletalSystem& system, const Assembly& assembly) {
  constexpr double kWorthTelling = 1e-6;
  if (assembly.moved < 0 || assembly.by < kWorthTelling) return {};
  const Coordinate& c = system.model().coordinates[assembly.moved];
  return fmt::format("to close the model's loops '{}' starts at {:.6g} {}, {:.2g} {} from the start given", c.name,
                     assembly.q(assembly.moved), c.unit(), assembly.by, c.unit());
}

}  // namespace veridyn::muscle
