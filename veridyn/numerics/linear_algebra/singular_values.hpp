#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

/// Which singular vectors are needed. Full: a square orthogonal matrix; thin: as many columns as singular values.
enum class SingularVectors {
  kNone,
  kFullV,
  kThinUAndFullV,
  kFullUAndV,
};

/// A = U diag(values) V', values descending; min(rows, columns) of them, none of a matrix without rows or columns.
/// Vectors that are not requested are empty.
struct SingularValues {
  Eigen::VectorXd values;
  Eigen::MatrixXd U;
  Eigen::MatrixXd V;
};

/// By two-sided Jacobi rotations: slower than bidiagonalisation and accurate for the smallest singular values too,
/// which total least squares lives on (Demmel & Veselic 1992).
[[nodiscard]] SingularValues singular_values(const Eigen::MatrixXd& matrix, SingularVectors vectors);

}  // namespace veridyn::numerics
