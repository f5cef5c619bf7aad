#include "veridyn/numerics/linear_algebra/matrix_exponential.hpp"

#include <unsupported/Eigen/MatrixFunctions>

#include "veridyn/core/assert.hpp"

namespace veridyn::numerics {

Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& matrix) {
  VERIDYN_ASSERT(matrix.rows() == matrix.cols());
  return matrix.exp();
}

SmallMatrix matrix_exponential(const SmallMatrix& matrix) {
  VERIDYN_ASSERT(matrix.rows() == matrix.cols());
  return matrix.exp();
}

}  // namespace veridyn::numerics
