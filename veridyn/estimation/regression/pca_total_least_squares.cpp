#include "veridyn/estimation/regression/pca_total_least_squares.hpp"

#include <cmath>

#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"

namespace veridyn::estimation {
namespace {

// Orthonormal basis of the column space of A (first) and of its complement (second); A has full column rank.
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> split_space(const Eigen::MatrixXd& A) {
  const Eigen::Index n = A.rows();
  if (A.cols() == 0) return {Eigen::MatrixXd::Zero(n, 0), Eigen::MatrixXd::Identity(n, n)};
  const Eigen::MatrixXd Q = numerics::HouseholderQr(A).Q();
  return {Q.leftCols(A.cols()), Q.rightCols(n - A.cols())};
}

}  // namespace

PcaTotalLeastSquares pca_total_least_squares(const Eigen::MatrixXd& triangle, const Eigen::MatrixXd& W, double rows,
                                             double signal_to_noise, bool scale_known, const Eigen::VectorXd& prior,
                                             const Eigen::VectorXd& weight) {
  const Eigen::Index n = triangle.cols() - 1;
  PcaTotalLeastSquares result;
  const WhitenedRegression white = whiten(triangle, W);
  const Eigen::Index count = white.singular_values.size();
  const double smallest = white.singular_values(count - 1);
  const double freedom = std::max(1.0, rows - static_cast<double>(n));
  result.singular_values = white.singular_values;
  result.error_scale = smallest * smallest / freedom;
  result.threshold = (signal_to_noise + 1.0) * std::sqrt(freedom) * (scale_known ? 1.0 : std::sqrt(result.error_scale));
  Eigen::Index k = 0;
  while (k < count - 1 && white.singular_values(k) > result.threshold) ++k;

  // Every h that the data allow: B y with h_z = -1.
  const Eigen::Index dimension = count - k + white.null_basis.cols();
  Eigen::MatrixXd B(n + 1, dimension);
  B << white.basis.rightCols(count - k), white.null_basis;
  // Directions in comparable units, or the split between a particular solution and the rest would depend on the
  // columns' units.
  Eigen::VectorXd unit(n + 1);
  unit << weight, 1.0;
  for (Eigen::Index j = 0; j < dimension; ++j) B.col(j) /= B.col(j).cwiseProduct(unit).norm();
  const Eigen::VectorXd b_z = B.row(n).transpose();
  result.theta = prior;
  result.jacobian = corrected_normal_matrix(triangle, W, smallest * smallest).matrix;
  if (!(b_z.norm() > 1e-10)) return result;
  const Eigen::MatrixXd free = split_space(b_z).second;  // keeps h_z
  const Eigen::VectorXd particular = (B * (-b_z / b_z.squaredNorm())).head(n);
  const Eigen::MatrixXd moves = weight.asDiagonal() * numerics::product(B.topRows(n), free);
  const auto [unexcited, excited] = split_space(moves);
  result.unexcited = unexcited;
  result.excited = excited;
  const Eigen::VectorXd offset = weight.cwiseProduct(particular - prior);
  result.theta = prior + weight.cwiseInverse().cwiseProduct(offset - unexcited * (unexcited.transpose() * offset));
  result.excited_directions = excited.cols();

  result.inverse_on_excited = Eigen::MatrixXd::Zero(n, n);
  if (excited.cols() > 0) {
    const Eigen::MatrixXd E = weight.cwiseInverse().asDiagonal() * excited;
    Eigen::MatrixXd inner = numerics::product(numerics::transposed_product(E, result.jacobian), E);
    const Eigen::VectorXd scale = inner.diagonal().cwiseAbs().cwiseSqrt();
    if (!(scale.array() > 0.0).all()) return result;
    const Eigen::VectorXd inverse_scale = scale.cwiseInverse();
    inner = numerics::scaled(inverse_scale, inner, inverse_scale);
    const numerics::Cholesky cholesky(inner);
    if (!cholesky.positive_definite()) return result;
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(inner.rows(), inner.cols());
    const Eigen::MatrixXd inverse = numerics::scaled(inverse_scale, cholesky.solve(identity), inverse_scale);
    result.inverse_on_excited = numerics::product_transposed(numerics::product(E, inverse), E);
  }
  result.solved = true;
  return result;
}

}  // namespace veridyn::estimation
