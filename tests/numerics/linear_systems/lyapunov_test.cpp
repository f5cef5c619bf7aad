#include "veridyn/numerics/linear_systems/lyapunov.hpp"

#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

TEST(Lyapunov, CovarianceOfADampedOscillatorUnderWhiteNoise) {
  // x'' + 2 zeta w x' + w^2 x = noise of density q: var x = q/(4 zeta w^3), var x' = q/(4 zeta w).
  const double zeta = 0.1, w = 3.0, q = 0.7;
  Eigen::Matrix2d A, Q = Eigen::Matrix2d::Zero();
  A << 0.0, 1.0, -w * w, -2.0 * zeta * w;
  Q(1, 1) = q;
  const MatrixSolution s = lyapunov(A, Q);
  EXPECT_NEAR(s.X(0, 0), q / (4.0 * zeta * w * w * w), 1e-15);
  EXPECT_NEAR(s.X(1, 1), q / (4.0 * zeta * w), 1e-14);
  EXPECT_NEAR(s.X(0, 1), 0.0, 1e-15);
  EXPECT_LT(s.residual, 1e-14);
}

TEST(DiscreteLyapunov, IsTheSumOfItsSeries) {
  std::srand(5);
  Eigen::MatrixXd A = Eigen::MatrixXd::Random(5, 5);
  A *= 0.6 / A.norm();
  const Eigen::MatrixXd half = Eigen::MatrixXd::Random(5, 5), Q = half * half.transpose();
  Eigen::MatrixXd term = Q, sum = Q;
  for (int k = 0; k < 200; ++k) sum += term = A * term * A.transpose();
  const MatrixSolution s = discrete_lyapunov(A, Q);
  EXPECT_LT((s.X - sum).norm(), 1e-13 * sum.norm());
  EXPECT_LT(s.residual, 1e-14);
}

TEST(Lyapunov, HoldsForManyRandomMatrices) {
  std::srand(11);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Index n = 1 + i % 9;
    const Eigen::MatrixXd A =
        Eigen::MatrixXd::Random(n, n) - 2.0 * static_cast<double>(n) * Eigen::MatrixXd::Identity(n, n);
    const Eigen::MatrixXd half = Eigen::MatrixXd::Random(n, n);
    EXPECT_LT(lyapunov(A, half * half.transpose()).residual, 1e-13) << i;
    EXPECT_LT(discrete_lyapunov(A, half * half.transpose()).residual, 1e-13) << i;
  }
}

TEST(Lyapunov, RefusesWhatHasNoSingleSolution) {
  Eigen::Matrix2d A;
  A << 0.0, 1.0, -4.0, 0.0;  // undamped
  EXPECT_THROW((void)lyapunov(A, Eigen::Matrix2d::Identity()), InputError);
  EXPECT_THROW((void)discrete_lyapunov(Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Identity()), InputError);
  EXPECT_THROW((void)lyapunov(A, Eigen::Matrix3d::Identity()), InputError);
}

}  // namespace
}  // namespace veridyn::numerics
