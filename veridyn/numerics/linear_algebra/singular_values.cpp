#include "veridyn/numerics/linear_algebra/singular_values.hpp"

#include <Eigen/SVD>

namespace veridyn::numerics {

SingularValues singular_values(const Eigen::MatrixXd& matrix, SingularVectors vectors) {
  const Eigen::Index rows = matrix.rows(), columns = matrix.cols();
  // Eigen's decomposition reads the first element, which such a matrix does not have. Any orthogonal matrix will do.
  if (rows == 0 || columns == 0) {
    SingularValues none;
    if (vectors == SingularVectors::kThinUAndFullV) none.U.resize(rows, 0);
    if (vectors == SingularVectors::kFullUAndV) none.U = Eigen::MatrixXd::Identity(rows, rows);
    if (vectors != SingularVectors::kNone) none.V = Eigen::MatrixXd::Identity(columns, columns);
    return none;
  }
  unsigned int options = 0;
  if (vectors == SingularVectors::kFullV) options = Eigen::ComputeFullV;
  if (vectors == SingularVectors::kThinUAndFullV) options = Eigen::ComputeThinU | Eigen::ComputeFullV;
  if (vectors == SingularVectors::kFullUAndV) options = Eigen::ComputeFullU | Eigen::ComputeFullV;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, options);
  SingularValues result{.values = svd.singularValues(), .U = {}, .V = {}};
  if (svd.computeU()) result.U = svd.matrixU();
  if (svd.computeV()) result.V = svd.matrixV();
  return result;
}

}  // namespace veridyn::numerics
