#include "veridyn/aircraft/identification/fit/error_variance.hpp"

#include <cmath>

#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::RegressionData;

/// Variance of z that neither the model nor the errors of the regressors explain: z'z/N - W_.. of the moment equations
/// (Fuller 1987, sec. 2.2), over the directions of the regressors that hold signal besides their error. The others,
/// such as those of terms that move together, would leave whatever rounding makes of them.
double unexplained_variance(const RegressionData& data) {
  constexpr double kDependent = 1e-10;
  constexpr double kMostError = 0.9;  // of a direction's power
  const auto n = data.parameters();
  const auto rows = static_cast<double>(data.rows());
  const Eigen::MatrixXd& W = data.error_covariance;
  const Eigen::VectorXd power = data.regressors.colwise().squaredNorm().transpose() / rows;
  // Columns of unlike size: scaled before eigenvalues say which depend on each other.
  const Eigen::VectorXd inverse = power.unaryExpr([](double p) { return p > 0.0 ? 1.0 / std::sqrt(p) : 0.0; });
  const Eigen::MatrixXd moments =
      numerics::scaled(inverse, data.regressors.transpose() * data.regressors / rows, inverse);
  const Eigen::VectorXd b =
      inverse.asDiagonal() * (data.regressors.transpose() * data.regressand / rows - W.topRightCorner(n, 1));
  const numerics::SymmetricEigen axes = numerics::symmetric_eigen(moments);
  const auto independent = (axes.values.array() > kDependent * axes.values.maxCoeff()).count();
  const Eigen::MatrixXd whiten =
      axes.vectors.rightCols(independent) * axes.values.tail(independent).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd errors = numerics::scaled(inverse, W.topLeftCorner(n, n), inverse);
  const numerics::SymmetricEigen share = numerics::symmetric_eigen(whiten.transpose() * errors * whiten);
  const Eigen::VectorXd projected = share.vectors.transpose() * (whiten.transpose() * b);
  double explained = 0.0;
  for (Eigen::Index j = 0; j < projected.size(); ++j)
    if (share.values(j) < kMostError) explained += projected(j) * projected(j) / (1.0 - share.values(j));
  return data.regressand.squaredNorm() / rows - explained;
}

}  // namespace

double least_response_variance(const Eigen::MatrixXd& W) {
  const auto n = W.rows() - 1;
  const Eigen::VectorXd shared = W.topRightCorner(n, 1);
  return 1.001 * shared.dot(numerics::shortest_least_squares(W.topLeftCorner(n, n), shared));
}

EquationError equation_error(const RegressionData& data) {
  const double unexplained = unexplained_variance(data);
  const auto n = data.parameters();
  const double by_sensors = data.error_covariance(n, n);
  const bool possible = unexplained > least_response_variance(data.error_covariance);
  return {possible ? unexplained : by_sensors, unexplained / by_sensors};
}

double residual_ratio(const RegressionData& data, const Eigen::VectorXd& theta) {
  Eigen::VectorXd v(theta.size() + 1);
  v << theta, -1.0;
  const double variance = (data.regressors * theta - data.regressand).squaredNorm() / static_cast<double>(data.rows());
  return variance / v.dot(data.error_covariance * v);
}

}  // namespace veridyn::aircraft
