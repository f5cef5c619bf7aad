#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

/// [Re A, -Im A; Im A, Re A]: products, inverses and eigenvalues (each twice) of the real form are those of the complex
/// matrix, so that the real decompositions serve both (Golub & Van Loan, Matrix Computations, 8.1).
[[nodiscard]] Eigen::MatrixXd real_form(const Eigen::MatrixXcd& matrix);

/// The complex matrix of a real form, as of a real form's inverse or other function.
[[nodiscard]] Eigen::MatrixXcd complex_form(const Eigen::MatrixXd& real);

/// A^-1 b of a regular square matrix.
[[nodiscard]] Eigen::VectorXcd solve_complex(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b);

}  // namespace veridyn::numerics
