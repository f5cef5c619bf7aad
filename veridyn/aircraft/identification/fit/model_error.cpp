#include "veridyn/aircraft/identification/fit/model_error.hpp"

#include <cmath>

#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::aircraft {

Eigen::MatrixXd model_error(const estimation::RegressionData& data, double unmodelled_share) {
  constexpr double kDependent = 1e-10;
  const Eigen::Index n = data.parameters();
  if (!(unmodelled_share > 0.0) || data.rows() == 0) return Eigen::MatrixXd::Zero(n, n);
  const double varies = (data.regressand.array() - data.regressand.mean()).matrix().squaredNorm();
  const double each = unmodelled_share * varies / static_cast<double>(n);
  // Columns of unlike size: scaled before eigenvalues say which depend on each other.
  const Eigen::VectorXd inverse =
      data.regressors.colwise().norm().transpose().unaryExpr([](double size) { return size > 0.0 ? 1.0 / size : 0.0; });
  const numerics::SymmetricEigen axes =
      numerics::symmetric_eigen(numerics::scaled(inverse, data.regressors.transpose() * data.regressors, inverse));
  const double least = kDependent * axes.values.maxCoeff();
  const Eigen::VectorXd root = axes.values.unaryExpr([&](double v) { return v > least ? std::sqrt(each / v) : 0.0; });
  return inverse.asDiagonal() * axes.vectors * root.asDiagonal();
}

}  // namespace veridyn::aircraft
