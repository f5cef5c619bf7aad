#include "veridyn/estimation/regression/total_least_squares.hpp"

#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_algebra/singular_values.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::estimation {
namespace {

constexpr double kNullOfCovariance = 1e-10;
constexpr double kDependentColumns = 1e-12;

Eigen::VectorXd with_minus_one(const Eigen::VectorXd& theta) {
  Eigen::VectorXd h(theta.size() + 1);
  h << theta, -1.0;
  return h;
}

}  // namespace

ErrorBasis error_basis(const Eigen::MatrixXd& W) {
  const Eigen::Index size = W.rows();
  std::vector<Eigen::Index> exact, noisy;
  for (Eigen::Index i = 0; i < size; ++i) (W(i, i) > 0.0 ? noisy : exact).push_back(i);
  const auto noisy_count = signed_index(noisy.size());
  Eigen::VectorXd sd(noisy_count);
  for (Eigen::Index i = 0; i < noisy_count; ++i) sd(i) = std::sqrt(W(noisy[i], noisy[i]));
  Eigen::MatrixXd correlation(noisy_count, noisy_count);
  for (Eigen::Index i = 0; i < noisy_count; ++i) {
    for (Eigen::Index j = 0; j < noisy_count; ++j) {
      correlation(i, j) = W(noisy[i], noisy[j]) / (sd(i) * sd(j));
    }
  }
  const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(correlation);
  Eigen::Index null_count = 0;
  while (null_count < noisy_count && eigen.values(null_count) < kNullOfCovariance * eigen.values(noisy_count - 1))
    ++null_count;

  // Columns of T: exact columns and null directions of W, then the whitened ones.
  const Eigen::Index exact_count = signed_index(exact.size()) + null_count;
  const Eigen::Index white_count = noisy_count - null_count;
  Eigen::MatrixXd T_exact = Eigen::MatrixXd::Zero(size, exact_count);
  Eigen::MatrixXd T_white = Eigen::MatrixXd::Zero(size, white_count);
  for (std::size_t i = 0; i < exact.size(); ++i) T_exact(exact[i], i) = 1.0;
  for (Eigen::Index i = 0; i < noisy_count; ++i) {
    const Eigen::Index row = noisy[i];
    for (Eigen::Index j = 0; j < null_count; ++j) {
      T_exact(row, signed_index(exact.size()) + j) = eigen.vectors(i, j) / sd(i);
    }
    for (Eigen::Index j = 0; j < white_count; ++j) {
      T_white(row, j) = eigen.vectors(i, null_count + j) / (sd(i) * std::sqrt(eigen.values(null_count + j)));
    }
  }
  return {.exact = T_exact, .white = T_white};
}

WhitenedRegression whiten(const Eigen::MatrixXd& triangle, const Eigen::MatrixXd& W) {
  const Eigen::Index size = triangle.cols();
  VERIDYN_ASSERT(W.rows() == size && W.cols() == size);
  ErrorBasis errors = error_basis(W);
  Eigen::MatrixXd& T_exact = errors.exact;
  const Eigen::MatrixXd& T_white = errors.white;
  const Eigen::Index exact_count = T_exact.cols(), white_count = T_white.cols();

  WhitenedRegression result;
  Eigen::MatrixXd T_rank = Eigen::MatrixXd::Zero(size, 0);
  result.null_basis = Eigen::MatrixXd::Zero(size, 0);
  if (exact_count > 0) {
    Eigen::VectorXd length = (triangle * T_exact).colwise().norm();
    for (double& l : length) l = l > 0.0 ? l : 1.0;
    T_exact = T_exact * length.cwiseInverse().asDiagonal();
    const numerics::SingularValues svd =
        numerics::singular_values(numerics::product(triangle, T_exact), numerics::SingularVectors::kFullV);
    Eigen::Index rank = 0;
    while (rank < exact_count && svd.values(rank) > kDependentColumns * svd.values(0)) ++rank;
    if (rank == exact_count) {
      T_rank = T_exact;  // untouched columns lose no digits
    } else {
      T_rank = T_exact * svd.V.leftCols(rank);
      result.null_basis = T_exact * svd.V.rightCols(exact_count - rank);
    }
  }
  result.exact = T_rank.cols();

  Eigen::MatrixXd T(size, T_rank.cols() + white_count);
  T << T_rank, T_white;
  const Eigen::MatrixXd R = retriangulate(numerics::product(triangle, T));
  const Eigen::MatrixXd R22 = R.bottomRightCorner(white_count, white_count);
  const numerics::SingularValues svd = numerics::singular_values(R22, numerics::SingularVectors::kFullV);
  result.singular_values = svd.values;
  const Eigen::MatrixXd& V = svd.V;
  result.basis = numerics::product(T_white, V);
  if (T_rank.cols() > 0) {
    const Eigen::MatrixXd R12V = numerics::product(R.topRightCorner(T_rank.cols(), white_count), V);
    result.basis -=
        numerics::product(T_rank, numerics::solve_upper(R.topLeftCorner(T_rank.cols(), T_rank.cols()), R12V));
  }
  return result;
}

CorrectedNormalMatrix corrected_normal_matrix(const Eigen::MatrixXd& triangle, const Eigen::MatrixXd& W,
                                              double s_squared) {
  const Eigen::Index n = triangle.cols() - 1;
  CorrectedNormalMatrix result;
  const Eigen::MatrixXd R = triangle.leftCols(n);
  Eigen::VectorXd length = R.colwise().norm();
  for (double& l : length) l = l > 0.0 ? l : 1.0;
  const Eigen::VectorXd inverse_length = length.cwiseInverse();
  const Eigen::MatrixXd unit = R * inverse_length.asDiagonal();
  const Eigen::MatrixXd noise = s_squared * numerics::scaled(inverse_length, W.topLeftCorner(n, n), inverse_length);
  const Eigen::MatrixXd normal = numerics::transposed_product(unit, unit);
  result.matrix = numerics::transposed_product(R, R) - s_squared * W.topLeftCorner(n, n);
  const numerics::Cholesky cholesky(normal);
  if (!cholesky.positive_definite()) {
    result.noise_share = 1.0;
    return result;
  }
  // Eigenvalues of noise relative to X'X are shares in [0, 1) for a generic problem.
  const Eigen::MatrixXd half = cholesky.solve_lower(noise);
  const Eigen::MatrixXd relative = cholesky.solve_lower(half.transpose());
  const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(0.5 * (relative + relative.transpose()));
  result.noise_share = eigen.values(n - 1);
  if (!(result.noise_share < 1.0 - 1e-9)) return result;
  const Eigen::VectorXd kept = (1.0 - eigen.values.array()).inverse().sqrt().matrix();
  const Eigen::MatrixXd root = cholesky.solve_upper(eigen.vectors * kept.asDiagonal());
  const Eigen::MatrixXd scaled = inverse_length.asDiagonal() * root;
  result.inverse = numerics::product_transposed(scaled, scaled);
  return result;
}

Eigen::MatrixXd white_score_covariance(const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& W,
                                       const Eigen::VectorXd& theta, double c, double rows, ErrorRatio ratio) {
  const Eigen::Index n = theta.size();
  const Eigen::VectorXd h = with_minus_one(theta);
  const Eigen::VectorXd Wh = (W * h).head(n);
  const double s2 = c * h.dot(W * h);
  const double sign = ratio == ErrorRatio::kKnown ? -1.0 : 1.0;
  return s2 * jacobian + rows * (s2 * c * W.topLeftCorner(n, n) + sign * c * c * Wh * Wh.transpose());
}

TotalLeastSquares total_least_squares(const Eigen::MatrixXd& triangle, const Eigen::MatrixXd& W, double rows,
                                      ErrorRatio ratio) {
  const Eigen::Index n = triangle.cols() - 1;
  TotalLeastSquares result;
  const WhitenedRegression white = whiten(triangle, W);
  const Eigen::Index last = white.singular_values.size() - 1;
  result.singular_values = white.singular_values;
  result.smallest = white.singular_values(last);
  result.full_rank = white.null_basis.cols() == 0;
  result.error_scale = result.smallest * result.smallest / std::max(1.0, rows - static_cast<double>(n));
  const Eigen::VectorXd h = white.basis.col(last);
  result.theta = Eigen::VectorXd::Zero(n);
  // Component along z against the whole, each in terms of what it contributes to the data.
  const Eigen::VectorXd contribution = triangle.colwise().norm().transpose().cwiseProduct(h.cwiseAbs());
  const double along_z = contribution.sum() > 0.0 ? contribution(n) / contribution.sum() : 0.0;
  if (!(along_z > 1e-10)) {
    result.noise_share = 1.0;
    return result;
  }
  result.theta = h.head(n) / (-h(n));
  const CorrectedNormalMatrix corrected = corrected_normal_matrix(triangle, W, result.smallest * result.smallest);
  result.jacobian = corrected.matrix;
  result.inverse_jacobian = corrected.inverse;
  result.noise_share = corrected.noise_share;
  result.solved = result.full_rank && corrected.inverse.size() > 0;
  if (result.solved) {
    result.covariance_white =
        result.inverse_jacobian *
        white_score_covariance(result.jacobian, W, result.theta, result.error_scale, rows, ratio) *
        result.inverse_jacobian;
  }
  return result;
}

Scores errors_in_variables_scores(const RowMatrix& X, const Eigen::VectorXd& z, const Eigen::MatrixXd& W,
                                  const Eigen::VectorXd& theta, ErrorRatio ratio) {
  const Eigen::Index n = theta.size();
  const Eigen::VectorXd h = with_minus_one(theta);
  // e'h = -(z - x theta) in errors, so x_hat = x - (W h)_x (D h)/(h'Wh) with D h = -residual.
  const Eigen::RowVectorXd Wh = (W * h).head(n).transpose();
  Scores scores;
  scores.residual = z - X * theta;
  scores.regressors = X + scores.residual * (Wh / h.dot(W * h));
  scores.quadratic = ratio == ErrorRatio::kEstimated ? Eigen::VectorXd(-Wh) : Eigen::VectorXd(Eigen::VectorXd::Zero(n));
  return scores;
}

}  // namespace veridyn::estimation
