#include "veridyn/numerics/linear_algebra/singular_values.hpp"

#include <Eigen/SVD>

namespace veridyn::numerics {

SingularValues singular_values(const Eigen::MatrixXd& matrix, SingularVectors vectors) {
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
