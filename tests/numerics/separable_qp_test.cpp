#include "veridyn/numerics/separable_qp.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::numerics {
namespace {

SeparableQp random_problem(RandomStream& random, Eigen::Index m, Eigen::Index n) {
  SeparableQp qp(m, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < m; ++k) qp.A(k, i) = random.normal();
    qp.weight(i) = std::exp(random.normal());
    qp.low(i) = -random.uniform();
    qp.high(i) = random.uniform();
  }
  // A right-hand side that some x within the bounds makes.
  Eigen::VectorXd x(n);
  for (Eigen::Index i = 0; i < n; ++i) x(i) = random.uniform(qp.low(i), qp.high(i));
  qp.b = qp.A * x;
  return qp;
}

TEST(SeparableQp, SolutionsSatisfyTheOptimalityConditions) {
  RandomStream random(5, "qp");
  for (int trial = 0; trial < 500; ++trial) {
    const auto m = static_cast<Eigen::Index>(1 + random.index(4));
    const auto n = m + static_cast<Eigen::Index>(1 + random.index(20));
    SeparableQp qp = random_problem(random, m, n);
    ASSERT_EQ(qp.solve(), QpEnd::kSolved);
    const Eigen::VectorXd& x = qp.x();
    EXPECT_LT((qp.A * x - qp.b).cwiseAbs().maxCoeff(), 1e-10);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double gradient = qp.weight(i) * x(i) - qp.A.col(i).dot(qp.multipliers());
      ASSERT_GE(x(i), qp.low(i));
      ASSERT_LE(x(i), qp.high(i));
      if (x(i) > qp.low(i) && x(i) < qp.high(i)) {
        EXPECT_NEAR(gradient, 0.0, 1e-9);
      } else {
        EXPECT_GE(x(i) == qp.low(i) ? gradient : -gradient, -1e-9);
      }
    }
  }
}

TEST(SeparableQp, WithoutBoundsItIsTheWeightedLeastNormSolution) {
  RandomStream random(6, "qp");
  SeparableQp qp = random_problem(random, 3, 8);
  qp.low.setConstant(-INFINITY);
  qp.high.setConstant(INFINITY);
  ASSERT_EQ(qp.solve(), QpEnd::kSolved);
  const Eigen::MatrixXd W = qp.weight.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd weighted = W * qp.A.transpose();
  const Eigen::MatrixXd squares = qp.A * weighted;
  const Eigen::VectorXd multipliers = solve_linear(squares, qp.b);
  const Eigen::VectorXd expected = weighted * multipliers;
  EXPECT_LT((qp.x() - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SeparableQp, SaysWhenNothingWithinTheBoundsWillDo) {
  SeparableQp qp(1, 2);
  qp.A << 1.0, 2.0;
  qp.b << 10.0;
  qp.low.setZero();
  qp.high.setOnes();
  EXPECT_EQ(qp.solve(), QpEnd::kInfeasible);
  EXPECT_DOUBLE_EQ(qp.x()(0), 1.0);
  EXPECT_DOUBLE_EQ(qp.x()(1), 1.0);
}

}  // namespace
}  // namespace veridyn::numerics
