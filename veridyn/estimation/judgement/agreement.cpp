#include "veridyn/estimation/judgement/agreement.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {

double agreement_p(const Eigen::VectorXd& difference, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0) || !covariance.allFinite()) return 1.0;
  // Scaled to unit variances: stiffnesses and inertias differ by orders of magnitude.
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const Eigen::VectorXd d = inverse.asDiagonal() * difference;
  const double chi_square = numerics::inverse_quadratic_form(numerics::scaled(inverse, covariance, inverse), d);
  return std::isfinite(chi_square)
             ? numerics::chi_square_upper_p(std::max(0.0, chi_square), static_cast<double>(d.size()))
             : 1.0;
}

}  // namespace veridyn::estimation
