#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

/// Square matrices of at most eight rows, stored in place: nothing is allocated.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 8, 8>;

/// exp(A), by scaling and squaring with Pade approximants (Higham 2005, SIAM J Matrix Anal Appl 26:1179).
[[nodiscard]] Eigen::MatrixXd matrix_exponential(const Eigen::MatrixXd& matrix);
/// The same bits without an allocation.
[[nodiscard]] SmallMatrix matrix_exponential(const SmallMatrix& matrix);

}  // namespace veridyn::numerics
