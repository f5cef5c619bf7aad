#include "veridyn/numerics/linear_algebra/real_form.hpp"

#include <gtest/gtest.h>

#include <complex>

#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::numerics {
namespace {

TEST(RealForm, MultipliesLikeTheComplexMatrices) {
  const Eigen::MatrixXcd A = Eigen::MatrixXcd::Random(3, 2), B = Eigen::MatrixXcd::Random(2, 4);
  EXPECT_TRUE(complex_form(real_form(A) * real_form(B)).isApprox(A * B, 1e-14));
  EXPECT_TRUE(complex_form(real_form(A).transpose()).isApprox(A.adjoint(), 1e-14));
}

// [[2, i], [-i, 2]] has the eigenvalues 1 and 3.
TEST(RealForm, OfAHermitianMatrixHasItsEigenvaluesTwice) {
  Eigen::MatrixXcd A(2, 2);
  A << 2.0, std::complex<double>(0.0, 1.0), std::complex<double>(0.0, -1.0), 2.0;
  const SymmetricEigen eigen = symmetric_eigen(real_form(A));
  EXPECT_TRUE(eigen.values.isApprox(Eigen::Vector4d(1.0, 1.0, 3.0, 3.0), 1e-14));
  EXPECT_TRUE(complex_form(from_eigen(eigen.vectors, eigen.values)).isApprox(A, 1e-14));
}

TEST(SolveComplex, SolvesTheEquations) {
  const Eigen::MatrixXcd A = Eigen::MatrixXcd::Random(5, 5);
  const Eigen::VectorXcd b = Eigen::VectorXcd::Random(5);
  EXPECT_TRUE((A * solve_complex(A, b)).isApprox(b, 1e-12));
}

}  // namespace
}  // namespace veridyn::numerics
