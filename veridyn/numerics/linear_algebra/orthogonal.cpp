#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

#include "veridyn/core/assert.hpp"

namespace veridyn::numerics {
namespace {

Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposed(const Eigen::MatrixXd& A, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  if (threshold > 0.0) decomposition.setThreshold(threshold);
  decomposition.compute(A);
  return decomposition;
}

}  // namespace

HouseholderQr::HouseholderQr(const Eigen::MatrixXd& matrix) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  reflectors_ = qr.matrixQR();
  coefficients_ = qr.hCoeffs();
  const Eigen::Index n = std::min(matrix.rows(), matrix.cols());
  R_ = reflectors_.topRows(n).triangularView<Eigen::Upper>();
}

Eigen::MatrixXd HouseholderQr::Q() const {
  const Eigen::Index n = reflectors_.rows();
  return Eigen::householderSequence(reflectors_, coefficients_) * Eigen::MatrixXd::Identity(n, n);
}

Eigen::MatrixXd HouseholderQr::thin_Q() const {
  return Eigen::householderSequence(reflectors_, coefficients_) *
         Eigen::MatrixXd::Identity(reflectors_.rows(), R_.rows());
}

Eigen::MatrixXd HouseholderQr::apply_transposed(const Eigen::MatrixXd& B) const {
  VERIDYN_ASSERT(B.rows() == reflectors_.rows());
  return Eigen::householderSequence(reflectors_, coefficients_).adjoint() * B;
}

Eigen::VectorXd HouseholderQr::apply_transposed(const Eigen::VectorXd& b) const {
  VERIDYN_ASSERT(b.size() == reflectors_.rows());
  return Eigen::householderSequence(reflectors_, coefficients_).adjoint() * b;
}

Eigen::MatrixXd HouseholderQr::solve(const Eigen::MatrixXd& B) const {
  VERIDYN_ASSERT(reflectors_.rows() >= reflectors_.cols());
  const Eigen::MatrixXd rotated = apply_transposed(B);
  return R_.triangularView<Eigen::Upper>().solve(rotated.topRows(R_.rows()));
}

Eigen::VectorXd HouseholderQr::solve(const Eigen::VectorXd& b) const {
  VERIDYN_ASSERT(reflectors_.rows() >= reflectors_.cols());
  const Eigen::VectorXd rotated = apply_transposed(b);
  return R_.triangularView<Eigen::Upper>().solve(rotated.head(R_.rows()));
}

Eliminated eliminate(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double threshold) {
  VERIDYN_ASSERT(A.rows() == B.rows());
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A.rows(), A.cols());
  qr.setThreshold(threshold);
  qr.compute(A);
  return {.rest = qr.householderQ().adjoint() * B, .rank = qr.rank()};
}

Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  VERIDYN_ASSERT(A.rows() == b.size());
  return A.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd shortest_least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double threshold) {
  VERIDYN_ASSERT(A.rows() == B.rows());
  return decomposed(A, threshold).solve(B);
}

Eigen::VectorXd shortest_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double threshold) {
  VERIDYN_ASSERT(A.rows() == b.size());
  return decomposed(A, threshold).solve(b);
}

Eigen::MatrixXd solve_linear(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  VERIDYN_ASSERT(A.rows() == A.cols() && A.rows() == B.rows());
  return A.partialPivLu().solve(B);
}

Eigen::VectorXd solve_linear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  VERIDYN_ASSERT(A.rows() == A.cols() && A.rows() == b.size());
  return A.partialPivLu().solve(b);
}

std::optional<Eigen::MatrixXd> inverse(const Eigen::MatrixXd& A) {
  VERIDYN_ASSERT(A.rows() == A.cols());
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(A);
  if (!lu.isInvertible()) return std::nullopt;
  return lu.inverse();
}

}  // namespace veridyn::numerics
