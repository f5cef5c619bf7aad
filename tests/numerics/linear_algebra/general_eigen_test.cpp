#include "veridyn/numerics/linear_algebra/general_eigen.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <vector>

namespace veridyn::numerics {
namespace {

// Companion matrix of (x - 1)(x + 2)(x^2 + 2 x + 5), whose roots are 1, -2 and -1 +- 2i.
Eigen::MatrixXd companion() {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(4, 4);
  // x^4 + 3 x^3 + 5 x^2 + x - 10
  A.row(0) << -3.0, -5.0, -1.0, 10.0;
  A.diagonal(-1).setOnes();
  return A;
}

TEST(GeneralEigen, FindsTheRootsOfAPolynomial) {
  const Eigen::VectorXcd values = general_eigenvalues(companion());
  using Complex = std::complex<double>;
  for (const Complex root : {Complex(1.0, 0.0), Complex(-2.0, 0.0), Complex(-1.0, 2.0), Complex(-1.0, -2.0)}) {
    const double nearest = (values.array() - root).abs().minCoeff();
    EXPECT_LT(nearest, 1e-12) << root;
  }
}

TEST(GeneralEigen, GivesVectorsThatTheMatrixScales) {
  const Eigen::MatrixXd A = companion();
  const GeneralEigen eigen = general_eigen(A);
  for (Eigen::Index k = 0; k < 4; ++k) {
    const Eigen::VectorXcd v = eigen.vectors.col(k);
    EXPECT_NEAR(v.norm(), 1.0, 1e-12);
    EXPECT_LT((A.cast<std::complex<double>>() * v - eigen.values(k) * v).norm(), 1e-12);
  }
}

TEST(RealSchur, IsASimilarMatrixWithABlockForEachComplexPair) {
  const Eigen::MatrixXd A = companion();
  const RealSchur schur = real_schur(A);
  EXPECT_TRUE((schur.U.transpose() * schur.U).isIdentity(1e-13));
  EXPECT_TRUE((schur.U * schur.T * schur.U.transpose()).isApprox(A, 1e-13));
  // Of the roots one pair is complex.
  EXPECT_EQ((schur.T.diagonal(-1).array() != 0.0).count(), 1);
  EXPECT_EQ((schur.T.diagonal(-2).array() != 0.0).count(), 0);
}

}  // namespace
}  // namespace veridyn::numerics
