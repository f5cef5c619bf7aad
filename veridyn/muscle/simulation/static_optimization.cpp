#include "veridyn/muscle/simulation/static_optimization.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace internal {

/// min sum |x_i|^p subject to B x = tau and low <= x <= high, through its dual.
///
/// At multipliers lambda each x_i follows from s_i = (B^T lambda)_i alone: where p |x|^(p-1) sign(x) = s, within its
/// bounds. The dual lambda^T tau - sum_i max_x (s_i x - |x|^p) is concave with gradient tau - B x. A proximal term
/// -mu/2 |lambda - centre|^2 makes the maximum unique when tau cannot be reached; moving the centre removes its trace.
struct SeparableProgram {
  double p = 2.0;
  Eigen::MatrixXd B;
  Eigen::VectorXd low, high, tau;
  Eigen::VectorXd lambda, centre, x, slope, gradient, step, trial;
  Eigen::MatrixXd hessian;
  Eigen::LLT<Eigen::MatrixXd> factor;
  int iterations = 0;

  void resize(Eigen::Index n, Eigen::Index m) {
    if (B.rows() == m && B.cols() == n) return;
    B.setZero(m, n);
    for (Eigen::VectorXd* v : {&low, &high, &x, &slope}) v->setZero(n);
    for (Eigen::VectorXd* v : {&tau, &lambda, &centre, &gradient, &step, &trial}) v->setZero(m);
    hessian.setZero(m, m);
  }

  // x and dx/ds at the multipliers; returns the dual's value.
  double primal(const Eigen::VectorXd& at, double mu) {
    double value = at.dot(tau) - 0.5 * mu * (at - centre).squaredNorm();
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const double s = B.col(i).dot(at);
      double free = 0.5 * s, rate = 0.5, cost;
      if (p != 2.0) {
        free = std::copysign(std::pow(std::abs(s) / p, 1.0 / (p - 1.0)), s);
        rate = std::min(std::pow(std::abs(free), 2.0 - p) / (p * (p - 1.0)), 1e9);
      }
      x(i) = std::clamp(free, low(i), high(i));
      slope(i) = free > low(i) && free < high(i) ? rate : 0.0;
      cost = p == 2.0 ? x(i) * x(i) : std::pow(std::abs(x(i)), p);
      value -= s * x(i) - cost;
    }
    return value;
  }

  // Newton's method with a line search on the concave dual. True when the gradient vanished.
  bool maximise(double mu, double tolerance) {
    double value = primal(lambda, mu);
    for (int i = 0; i < 100; ++i, ++iterations) {
      gradient.noalias() = tau - B * x - mu * (lambda - centre);
      if (!(gradient.cwiseAbs().maxCoeff() > tolerance)) return gradient.allFinite();
      hessian.noalias() = B * slope.asDiagonal() * B.transpose();
      hessian.diagonal().array() += mu;
      factor.compute(hessian);
      step = factor.solve(gradient);
      const double ascent = gradient.dot(step);
      double length = 1.0;
      bool better = false;
      for (int half = 0; half < 60 && !better; ++half, length *= 0.5) {
        trial.noalias() = lambda + length * step;
        const double next = primal(trial, mu);
        better = next >= value + 1e-4 * length * ascent;
        if (!better) {
          // At rounding the value no longer decides; a smaller gradient does.
          const double after = (tau - B * x - mu * (trial - centre)).cwiseAbs().maxCoeff();
          better =
              std::abs(next - value) <= 1e-13 * (1.0 + std::abs(value)) && after < 0.9 * gradient.cwiseAbs().maxCoeff();
        }
        if (better) value = next;
      }
      if (!better) {
        primal(lambda, mu);
        return false;
      }
      lambda.swap(trial);
    }
    return false;
  }

  // True when B x = tau to the tolerance.
  bool solve(double tolerance) {
    const double scale = B.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, B.rows()));
    const double mu = 1e-11 * (scale > 0.0 ? scale : 1.0);
    // Each move of the centre shrinks the trace of mu by many orders, where a balance exists at all.
    for (int move = 0; move < 4; ++move) {
      centre = lambda;
      maximise(mu, 1e-4 * tolerance);
      primal(lambda, mu);
      if (move > 0 && (tau - B * x).cwiseAbs().maxCoeff() <= tolerance) return true;
      if (lambda.cwiseAbs().maxCoeff() * std::sqrt(scale) > 1e8) return false;  // diverges: no balance exists
    }
    return false;
  }
};

}  // namespace internal

namespace {

using Jet = ceres::Jet<double, 1>;

}  // namespace

struct StaticOptimizer::Work {
  MuscleGroup<double> muscles;
  MuscleGroup<Jet> with_slopes;
  internal::SeparableProgram program;
  std::vector<RigidTendonForces> forces;
  std::vector<Jet> activation, length, speed;
  std::vector<RigidTendonParts<Jet>> parts;
  Eigen::VectorXd offset, gain;
  Eigen::MatrixXd arms;        // along the directions
  Eigen::VectorXd required;    // the same
  Eigen::VectorXd multiplier;  // of the last frame, by coordinate
};

void StaticOptimizationOptions::validate() const {
  if (!(exponent > 1.0) || !std::isfinite(exponent))
    throw InputError("static optimization", fmt::format("exponent is {}; must be > 1", exponent));
  if (!(tolerance > 0.0))
    throw InputError("static optimization", fmt::format("tolerance is {}; must be > 0", tolerance));
  if (!(reserve_bound > 0.0))
    throw InputError("static optimization", fmt::format("reserve_bound is {}; must be > 0", reserve_bound));
  for (const double optimal : reserve)
    if (!(optimal >= 0.0) || !std::isfinite(optimal))
      throw InputError("static optimization", fmt::format("a reserve is {}; must be >= 0", optimal));
}

StaticOptimizer::StaticOptimizer(std::span<const MuscleParameters> muscles, StaticOptimizationOptions options)
    : options_(std::move(options)), work_(std::make_unique<Work>()) {
  options_.validate();
  for (const MuscleParameters& p : muscles)
    if (!(p.min_control >= 0.0 && p.min_control <= p.max_control))
      throw InputError(fmt::format("muscle {}", p.name),
                       fmt::format("its controls range from {:.6g} to {:.6g}; the least must be >= 0 and not above the "
                                   "greatest",
                                   p.min_control, p.max_control));
  work_->muscles = MuscleGroup<double>(muscles);
  const std::size_t n = muscles.size();
  work_->forces.resize(n);
  if (options_.force == StaticForce::kWithPassive) {
    std::vector<MusculotendonParameters<Jet>> parameters;
    for (const MuscleParameters& p : muscles) parameters.push_back(p.musculotendon.cast<Jet>());
    work_->with_slopes = work_->muscles.with<Jet>(parameters);
    for (auto* list : {&work_->activation, &work_->length, &work_->speed}) list->resize(n);
    work_->parts.resize(n);
  }
  work_->offset.setZero(n);
  work_->gain.setZero(n);
}

StaticOptimizer::~StaticOptimizer() = default;
StaticOptimizer::StaticOptimizer(StaticOptimizer&&) noexcept = default;
StaticOptimizer& StaticOptimizer::operator=(StaticOptimizer&&) noexcept = default;

void StaticOptimizer::restart() {
  work_->program.lambda.setZero();
  work_->multiplier.setZero();
}

/// Bounds of all controls, and what the reserves do: muscles first, then reserves.
void StaticOptimizer::bound_controls(Eigen::Index n, const Eigen::MatrixXd* directions, Eigen::Index balances) {
  const auto reserves = static_cast<Eigen::Index>(options_.reserve.size());
  internal::SeparableProgram& q = work_->program;
  q.resize(n + reserves, balances);
  q.p = options_.exponent;
  q.iterations = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    q.low(i) = work_->muscles.settings(static_cast<std::size_t>(i)).min_control;
    q.high(i) = work_->muscles.settings(static_cast<std::size_t>(i)).max_control;
  }
  for (Eigen::Index j = 0; j < reserves; ++j) {
    const double optimal = options_.reserve[j];
    if (directions != nullptr) {
      q.B.col(n + j) = directions->row(j).transpose() * optimal;
    } else {
      q.B.col(n + j).setZero();
      q.B(j, n + j) = optimal;
    }
    q.low(n + j) = optimal > 0.0 ? -options_.reserve_bound : 0.0;
    q.high(n + j) = optimal > 0.0 ? options_.reserve_bound : 0.0;
  }
}

/// Solves with forces offset + gain a; true when they balance `required`.
bool StaticOptimizer::balance(const Eigen::MatrixXd& arms, const Eigen::VectorXd& required, double tolerance) {
  Work& w = *work_;
  for (Eigen::Index i = 0; i < arms.rows(); ++i) w.program.B.col(i) = arms.row(i).transpose() * w.gain(i);
  w.program.tau.noalias() = required - arms.transpose() * w.offset;
  return w.program.solve(tolerance);
}

/// The same with forces that are not linear in a: linearised at the last activations until these settle.
StaticOptimizer::Balance StaticOptimizer::balance_with_passive(const Eigen::MatrixXd& arms,
                                                               std::span<const double> length,
                                                               std::span<const double> speed,
                                                               const Eigen::VectorXd& required, double tolerance,
                                                               const Eigen::VectorXd& start) {
  Work& w = *work_;
  internal::SeparableProgram& q = w.program;
  const Eigen::Index n = arms.rows();
  Balance result{false, false};
  q.x.head(n) = q.low.head(n);
  for (std::size_t i = 0; i < length.size(); ++i) {
    w.length[i] = Jet(length[i]);
    w.speed[i] = Jet(speed[i]);
    w.activation[i] =
        Jet(start.size() == n ? std::clamp(start(i), q.low(i), q.high(i)) : 0.5 * (q.low(i) + q.high(i)), 0);
  }
  for (int round = 0; round < 50 && !result.settled; ++round) {
    w.with_slopes.rigid_parts(w.activation, w.length, w.speed, w.parts);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Jet total = w.parts[i].active + w.parts[i].passive;
      w.gain(i) = total.v[0];
      w.offset(i) = total.a - total.v[0] * w.activation[i].a;
    }
    result.balanced = balance(arms, required, tolerance);
    double change = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      change = std::max(change, std::abs(q.x(i) - w.activation[i].a));
      // Full steps at first; smaller ones should they not settle.
      const double share = round < 20 ? 1.0 : 0.5;
      w.activation[i] = Jet(w.activation[i].a + share * (q.x(i) - w.activation[i].a), 0);
    }
    result.settled = change < 1e-11;
  }
  w.with_slopes.rigid_parts(w.activation, w.length, w.speed, w.parts);
  return result;
}

void StaticOptimizer::fill(const Eigen::MatrixXd& arms, const Eigen::VectorXd& required,
                           const Eigen::MatrixXd* directions, StaticOptimizationFrame& frame) {
  Work& w = *work_;
  const internal::SeparableProgram& q = w.program;
  const Eigen::Index n = arms.rows(), m = arms.cols();
  frame.activation = q.x.head(n);
  frame.force.resize(n);
  for (Eigen::Index i = 0; i < n; ++i)
    frame.force(i) =
        options_.force == StaticForce::kWithPassive ? (w.parts[i].active + w.parts[i].passive).a : w.gain(i) * q.x(i);
  frame.reserve.setZero(m);
  frame.unbalanced = required;
  frame.unbalanced.noalias() -= arms.transpose() * frame.force;
  for (Eigen::Index j = 0; j < q.x.size() - n; ++j) {
    frame.reserve(j) = q.x(n + j);
    frame.unbalanced(j) -= options_.reserve[j] * q.x(n + j);
  }
  frame.multiplier = q.lambda;
  if (directions != nullptr) {
    frame.unbalanced = *directions * (directions->transpose() * frame.unbalanced).eval();
    frame.multiplier = *directions * q.lambda;
  }
  w.multiplier = frame.multiplier;
  frame.cost = q.x.cwiseAbs().array().pow(q.p).sum();
  frame.iterations = q.iterations;
}

void StaticOptimizer::solve(const Eigen::MatrixXd& arms, const Eigen::VectorXd& path_length,
                            const Eigen::VectorXd& path_speed, const Eigen::VectorXd& required,
                            StaticOptimizationFrame& frame, const Eigen::MatrixXd* directions) {
  Work& w = *work_;
  const Eigen::Index n = arms.rows(), m = arms.cols();
  const auto count = static_cast<std::size_t>(n);
  VERIDYN_ASSERT(count == w.muscles.size() && path_length.size() == n && path_speed.size() == n &&
                 required.size() == m);
  VERIDYN_ASSERT(options_.reserve.empty() || static_cast<Eigen::Index>(options_.reserve.size()) == m);
  VERIDYN_ASSERT(directions == nullptr || directions->rows() == m);
  bound_controls(n, directions, directions != nullptr ? directions->cols() : m);
  if (directions != nullptr) {
    w.arms.noalias() = arms * *directions;
    w.required.noalias() = directions->transpose() * required;
    if (w.multiplier.size() == m) w.program.lambda.noalias() = directions->transpose() * w.multiplier;
  }
  const Eigen::MatrixXd& balanced_arms = directions != nullptr ? w.arms : arms;
  const Eigen::VectorXd& balanced_required = directions != nullptr ? w.required : required;
  const std::span<const double> length(path_length.data(), count), speed(path_speed.data(), count);
  const double tolerance = options_.tolerance * (1.0 + required.cwiseAbs().maxCoeff());
  w.offset.setZero();
  Balance result{false, true};
  switch (options_.force) {
    case StaticForce::kIsometric:
      for (std::size_t i = 0; i < count; ++i) w.gain(i) = w.muscles.max_isometric_force(i);
      result.balanced = balance(balanced_arms, balanced_required, tolerance);
      break;
    case StaticForce::kAsOpenSim:
      w.muscles.rigid_forces(1.0, length, speed, w.forces);
      for (std::size_t i = 0; i < count; ++i) w.gain(i) = w.forces[i].active;
      result.balanced = balance(balanced_arms, balanced_required, tolerance);
      break;
    case StaticForce::kWithPassive:
      result = balance_with_passive(balanced_arms, length, speed, balanced_required, tolerance, frame.activation);
      break;
  }
  fill(arms, required, directions, frame);
  const bool finite = frame.activation.allFinite() && frame.unbalanced.allFinite();
  if (!finite || !result.settled) {
    frame.end = StaticEnd::kIterations;
  } else {
    const bool small = frame.unbalanced.cwiseAbs().maxCoeff() <= 10.0 * tolerance;
    frame.end = result.balanced && small ? StaticEnd::kBalanced : StaticEnd::kInfeasible;
  }
  // Diverged multipliers are no start for the next frame.
  if (frame.end != StaticEnd::kBalanced) restart();
}

}  // namespace veridyn::muscle
