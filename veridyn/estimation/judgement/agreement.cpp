#include "veridyn/estimation/judgement/agreement.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {

Agreement agreement(const Eigen::VectorXd& difference, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt();
  if (!(scale.array() > 0.0).all() || !covariance.allFinite()) return {};
  // Scaled to unit variances: stiffnesses and inertias differ by orders of magnitude.
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const Eigen::VectorXd d = inverse.asDiagonal() * difference;
  const double chi_square = numerics::inverse_quadratic_form(numerics::scaled(inverse, covariance, inverse), d);
  if (!std::isfinite(chi_square)) return {};
  const auto freedom = static_cast<double>(d.size());
  const double positive = std::max(0.0, chi_square);
  return {.p = numerics::chi_square_upper_p(positive, freedom), .ratio = positive / freedom};
}

double agreement_p(const Eigen::VectorXd& difference, const Eigen::MatrixXd& covariance) {
  return agreement(difference, covariance).p;
}

}  // namespace veridyn::estimation
