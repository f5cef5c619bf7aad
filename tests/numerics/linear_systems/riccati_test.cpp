#include "veridyn/numerics/linear_systems/riccati.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_systems/lyapunov.hpp"

namespace veridyn::numerics {
namespace {

using Eigen::MatrixXd;

MatrixXd scalar(double value) { return MatrixXd::Constant(1, 1, value); }

TEST(LinearQuadratic, OfOneStateIsItsClosedForm) {
  // 2 a p - b^2 p^2/r + q = 0
  const double a = 0.7, b = 2.0, q = 3.0, r = 0.5;
  const double p = r / (b * b) * (a + std::sqrt(a * a + b * b * q / r));
  const LinearQuadratic s = linear_quadratic(scalar(a), scalar(b), scalar(q), scalar(r));
  EXPECT_NEAR(s.P(0, 0), p, 1e-13);
  EXPECT_NEAR(s.K(0, 0), b * p / r, 1e-13);
  EXPECT_NEAR(s.slowest, -std::sqrt(a * a + b * b * q / r), 1e-12);
}

TEST(LinearQuadratic, OfADoubleIntegratorIsItsClosedForm) {
  // Q = diag(1, 0), R = 1: K = [1, sqrt 2].
  MatrixXd A = MatrixXd::Zero(2, 2), B = MatrixXd::Zero(2, 1), Q = A;
  A(0, 1) = B(1, 0) = Q(0, 0) = 1.0;
  const LinearQuadratic s = linear_quadratic(A, B, Q, scalar(1.0));
  EXPECT_NEAR(s.K(0, 0), 1.0, 1e-12);
  EXPECT_NEAR(s.K(0, 1), std::sqrt(2.0), 1e-12);
}

TEST(DiscreteLinearQuadratic, OfOneStateIsItsClosedForm) {
  // p = a^2 p r/(r + b^2 p) + q
  const double a = 1.2, b = 0.5, q = 2.0, r = 1.5;
  const double half = r * (1.0 - a * a) - b * b * q;
  const double p = (-half + std::sqrt(half * half + 4.0 * b * b * r * q)) / (2.0 * b * b);
  const LinearQuadratic s = discrete_linear_quadratic(scalar(a), scalar(b), scalar(q), scalar(r));
  EXPECT_NEAR(s.P(0, 0), p, 1e-12);
  EXPECT_NEAR(s.K(0, 0), a * b * p / (r + b * b * p), 1e-13);
}

/// Random problems of several sizes, with and without a cross term; some unstable.
struct Example {
  MatrixXd A, B, Q, R, N;
};

Example example(int seed) {
  std::srand(static_cast<unsigned>(seed));
  const Eigen::Index n = 2 + seed % 8, m = 1 + seed % 3;
  const MatrixXd half = MatrixXd::Random(n + m, n + m);
  const MatrixXd weight = half * half.transpose() + 0.01 * MatrixXd::Identity(n + m, n + m);
  return {2.0 * MatrixXd::Random(n, n), MatrixXd::Random(n, m), weight.topLeftCorner(n, n),
          weight.bottomRightCorner(m, m),
          seed % 2 == 0 ? MatrixXd(weight.topRightCorner(n, m)) : MatrixXd(MatrixXd::Zero(n, m))};
}

/// Of u = -K x from states of covariance 1: trace of the cost's Lyapunov equation.
double cost(const Example& e, const MatrixXd& K, bool discrete) {
  const MatrixXd closed = (e.A - e.B * K).transpose(), NK = e.N * K;
  const MatrixXd weight = e.Q + K.transpose() * e.R * K - NK - NK.transpose();
  return (discrete ? discrete_lyapunov(closed, weight) : lyapunov(closed, weight)).X.trace();
}

TEST(LinearQuadratic, LeavesNoResidualAndNoPerturbedGainCostsLess) {
  int tried = 0;
  for (const bool discrete : {false, true}) {
    for (int seed = 1; seed <= 25; ++seed) {
      const Example e = example(seed);
      const LinearQuadratic s =
          discrete ? discrete_linear_quadratic(e.A, e.B, e.Q, e.R, e.N) : linear_quadratic(e.A, e.B, e.Q, e.R, e.N);
      EXPECT_LT(s.residual, 1e-9) << seed << discrete;
      EXPECT_TRUE(discrete ? s.slowest < 1.0 : s.slowest < 0.0);
      const double least = cost(e, s.K, discrete);
      EXPECT_NEAR(least / s.P.trace(), 1.0, 1e-8) << seed;
      for (int i = 0; i < 40; ++i) {
        const MatrixXd K = s.K + 0.01 * s.K.norm() * MatrixXd::Random(s.K.rows(), s.K.cols());
        const Eigen::VectorXcd poles = (e.A - e.B * K).eigenvalues();
        if (discrete ? poles.cwiseAbs().maxCoeff() >= 1.0 : poles.real().maxCoeff() >= 0.0) continue;
        EXPECT_GE(cost(e, K, discrete), least * (1.0 - 1e-9)) << seed;
        ++tried;
      }
    }
  }
  EXPECT_GT(tried, 1000);
}

TEST(LinearQuadratic, RefusesWhatItCannotMakeStable) {
  MatrixXd A = MatrixXd::Identity(2, 2), B = MatrixXd::Zero(2, 1);
  B(0, 0) = 1.0;  // the second mode grows whatever is done
  EXPECT_THROW((void)linear_quadratic(A, B, MatrixXd::Identity(2, 2), scalar(1.0)), InputError);
  EXPECT_THROW((void)discrete_linear_quadratic(2.0 * A, B, MatrixXd::Identity(2, 2), scalar(1.0)), InputError);
  // An oscillation that costs nothing stays on the border.
  A << 0.0, 1.0, -1.0, 0.0;
  EXPECT_THROW((void)linear_quadratic(A, B, MatrixXd::Zero(2, 2), scalar(1.0)), InputError);
  EXPECT_THROW((void)linear_quadratic(A, B, MatrixXd::Identity(2, 2), scalar(0.0)), InputError);
  EXPECT_THROW((void)linear_quadratic(A, B, MatrixXd::Identity(3, 3), scalar(1.0)), InputError);
}

}  // namespace
}  // namespace veridyn::numerics
