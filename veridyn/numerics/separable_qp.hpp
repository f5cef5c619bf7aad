#pragma once

#include <Eigen/Core>
#include <span>

namespace veridyn::numerics {

/// How `SeparableQp` ended.
enum class QpEnd {
  kSolved,
  kInfeasible,  ///< no x within the bounds satisfies the equations; the least squares one is given
};

/// min sum weight_i x_i^2 / 2 subject to A x = b and low <= x <= high: few equations, many bounded unknowns, such as
/// the muscles that share the moments of a few joints.
///
/// The dual has one unknown an equation: x_i = clamp(a_i . lambda / weight_i), and Newton's method on A x(lambda) = b,
/// whose pieces are linear, ends after a few factorisations of an equations x equations matrix at the exact solution
/// (a finite method, as its line search keeps the concave dual rising; cf. Nocedal & Wright 2006, ch. 16). No
/// allocation after construction.
class SeparableQp {
 public:
  SeparableQp(Eigen::Index equations, Eigen::Index unknowns);

  Eigen::MatrixXd A;  ///< equations x unknowns
  Eigen::VectorXd b;
  Eigen::VectorXd weight;     ///< > 0
  Eigen::VectorXd low, high;  ///< may be infinite

  /// Solves from the multipliers of the last call.
  QpEnd solve();
  [[nodiscard]] const Eigen::VectorXd& x() const { return x_; }
  [[nodiscard]] const Eigen::VectorXd& multipliers() const { return lambda_; }
  [[nodiscard]] int iterations() const { return iterations_; }

 private:
  double dual(const Eigen::VectorXd& lambda, Eigen::VectorXd& x) const;

  Eigen::VectorXd x_, lambda_, residual_, step_, trial_, trial_x_;
  Eigen::MatrixXd normal_;
  int iterations_ = 0;
};

}  // namespace veridyn::numerics
