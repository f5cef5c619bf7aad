#include "veridyn/numerics/linear_algebra/real_form.hpp"

#include "veridyn/core/assert.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

namespace veridyn::numerics {

Eigen::MatrixXd real_form(const Eigen::MatrixXcd& matrix) {
  const Eigen::Index m = matrix.rows(), n = matrix.cols();
  Eigen::MatrixXd real(2 * m, 2 * n);
  real.topLeftCorner(m, n) = real.bottomRightCorner(m, n) = matrix.real();
  real.bottomLeftCorner(m, n) = matrix.imag();
  real.topRightCorner(m, n) = -matrix.imag();
  return real;
}

Eigen::MatrixXcd complex_form(const Eigen::MatrixXd& real) {
  VERIDYN_ASSERT(real.rows() % 2 == 0 && real.cols() % 2 == 0);
  const Eigen::Index m = real.rows() / 2, n = real.cols() / 2;
  Eigen::MatrixXcd matrix(m, n);
  matrix.real() = real.topLeftCorner(m, n);
  matrix.imag() = real.bottomLeftCorner(m, n);
  return matrix;
}

Eigen::VectorXcd solve_complex(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b) {
  VERIDYN_ASSERT(A.rows() == A.cols() && A.rows() == b.size());
  const Eigen::Index n = b.size();
  Eigen::VectorXd stacked(2 * n);
  stacked << b.real(), b.imag();
  const Eigen::VectorXd x = solve_linear(real_form(A), stacked);
  Eigen::VectorXcd result(n);
  result.real() = x.head(n);
  result.imag() = x.tail(n);
  return result;
}

}  // namespace veridyn::numerics
