#include "veridyn/estimation/regression/ordinary_least_squares.hpp"

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_algebra/singular_values.hpp"

namespace veridyn::estimation {

OrdinaryLeastSquares ordinary_least_squares(const Eigen::MatrixXd& triangle) {
  VERIDYN_ASSERT(triangle.rows() == triangle.cols() && triangle.cols() >= 2);
  const Eigen::Index n = triangle.cols() - 1;
  OrdinaryLeastSquares result;
  Eigen::VectorXd length = triangle.leftCols(n).colwise().norm();
  for (double& l : length) l = l > 0.0 ? l : 1.0;
  const Eigen::MatrixXd unit = triangle.topLeftCorner(n, n) * length.cwiseInverse().asDiagonal();
  const numerics::SingularValues svd = numerics::singular_values(unit, numerics::SingularVectors::kFullUAndV);
  result.singular_values = svd.values;
  const double largest = result.singular_values(0), smallest = result.singular_values(n - 1);
  result.condition_number = smallest > 0.0 ? largest / smallest : kInfinity;
  result.full_rank = smallest > 1e-13 * largest;
  const Eigen::VectorXd inverse =
      result.singular_values.unaryExpr([&](double s) { return s > 1e-13 * largest ? 1.0 / s : 0.0; });
  const Eigen::MatrixXd back = numerics::scaled(length.cwiseInverse(), svd.V, inverse);
  result.theta = back * (svd.U.transpose() * triangle.col(n).head(n));
  result.inverse_normal = numerics::product_transposed(back, back);
  // With full rank this is the last diagonal element; otherwise part of z is in rows in which R_x is zero.
  result.residual_sum_of_squares = (triangle.col(n) - triangle.leftCols(n) * result.theta).squaredNorm();
  if (result.full_rank) {
    result.theta = numerics::solve_upper(triangle.topLeftCorner(n, n), Eigen::VectorXd(triangle.col(n).head(n)));
    result.residual_sum_of_squares = triangle(n, n) * triangle(n, n);
  }
  return result;
}

}  // namespace veridyn::estimation
