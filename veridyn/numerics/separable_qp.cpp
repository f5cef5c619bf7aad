#include "veridyn/numerics/separable_qp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace veridyn::numerics {

SeparableQp::SeparableQp(Eigen::Index equations, Eigen::Index unknowns)
    : A(Eigen::MatrixXd::Zero(equations, unknowns)),
      b(Eigen::VectorXd::Zero(equations)),
      weight(Eigen::VectorXd::Ones(unknowns)),
      low(Eigen::VectorXd::Constant(unknowns, -INFINITY)),
      high(Eigen::VectorXd::Constant(unknowns, INFINITY)),
      x_(Eigen::VectorXd::Zero(unknowns)),
      lambda_(Eigen::VectorXd::Zero(equations)),
      residual_(equations),
      step_(equations),
      trial_(equations),
      trial_x_(unknowns),
      normal_(equations, equations) {}

double SeparableQp::dual(const Eigen::VectorXd& lambda, Eigen::VectorXd& x) const {
  double value = b.dot(lambda);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double slope = A.col(i).dot(lambda);
    x(i) = std::clamp(slope / weight(i), low(i), high(i));
    value += x(i) * (0.5 * weight(i) * x(i) - slope);
  }
  return value;
}

QpEnd SeparableQp::solve() {
  constexpr int kMostIterations = 200;
  double value = dual(lambda_, x_);
  const double size = 1.0 + b.cwiseAbs().maxCoeff();
  for (iterations_ = 0; iterations_ < kMostIterations; ++iterations_) {
    residual_.noalias() = b - A * x_;
    const double error = residual_.cwiseAbs().maxCoeff();
    if (error <= 1e-12 * size) return QpEnd::kSolved;
    normal_.setZero();
    for (Eigen::Index i = 0; i < x_.size(); ++i) {
      if (x_(i) > low(i) && x_(i) < high(i)) normal_.noalias() += A.col(i) * (A.col(i).transpose() / weight(i));
    }
    // Where too few unknowns are free to move a step along the residual is taken, scaled as if all were.
    const double regularisation = 1e-14 * normal_.trace() + 1e-300;
    normal_.diagonal().array() += regularisation;
    step_ = normal_.ldlt().solve(residual_);
    if (!step_.allFinite() || step_.dot(residual_) <= 0.0) step_ = residual_;
    double length = 1.0;
    double next = dual(trial_ = lambda_ + step_, trial_x_);
    for (int halvings = 0; !(next > value) && halvings < 60; ++halvings) {
      length *= 0.5;
      next = dual(trial_ = lambda_ + length * step_, trial_x_);
    }
    if (!(next > value)) return error <= 1e-8 * size ? QpEnd::kSolved : QpEnd::kInfeasible;
    lambda_ = trial_;
    x_ = trial_x_;
    value = next;
  }
  return (b - A * x_).cwiseAbs().maxCoeff() <= 1e-8 * size ? QpEnd::kSolved : QpEnd::kInfeasible;
}

}  // namespace veridyn::numerics
