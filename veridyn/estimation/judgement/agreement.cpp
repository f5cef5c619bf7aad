#include "veridyn/estimation/judgement/agreement.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {

double agreement_p(const Eigen::VectorXd& difference, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0) || !covariance.allFinite()) return 1.0;
  // Scaled to unit variances: stiffnesses and inertias differ by orders of magnitude.
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const Eigen::LDLT<Eigen::MatrixXd> factor(inverse.asDiagonal() * covariance * inverse.asDiagonal());
  const Eigen::VectorXd d = inverse.asDiagonal() * difference;
  const double chi_square = d.dot(factor.solve(d));
  return std::isfinite(chi_square)
             ? numerics::chi_square_upper_p(std::max(0.0, chi_square), static_cast<double>(d.size()))
             : 1.0;
}

}  // namespace veridyn::estimation
