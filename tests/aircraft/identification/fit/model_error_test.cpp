#include "veridyn/aircraft/identification/fit/model_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

/// A constant and two regressors that share half of their variance, and a response to the first.
estimation::RegressionData two_regressors(Eigen::Index rows) {
  numerics::RandomStream random(4, "regressors");
  estimation::RegressionData data;
  data.regressors.resize(rows, 3);
  data.regressand.resize(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double shared = random.normal();
    data.regressors.row(i) << 1.0, shared, 100.0 * (shared + random.normal());
    data.regressand(i) = 5.0 + 2.0 * shared + random.normal();
  }
  data.parameter_names = {"0", "a", "b"};
  return data;
}

TEST(ModelError, IsThePowerOfWhatIsNotModelledInEachParameter) {
  const estimation::RegressionData data = two_regressors(2000);
  const Eigen::MatrixXd root = model_error(data, 0.3);
  const double power = 0.3 * (data.regressand.array() - data.regressand.mean()).square().sum();
  const Eigen::MatrixXd squares = data.regressors.transpose() * data.regressors;
  const Eigen::MatrixXd expected =
      numerics::solve_linear(squares, Eigen::MatrixXd(power / 3.0 * Eigen::MatrixXd::Identity(3, 3)));
  EXPECT_LT((root * root.transpose() - expected).norm(), 1e-9 * expected.norm());
  // What the regressors explain with such errors is as much as is left over.
  EXPECT_NEAR((data.regressors * root).squaredNorm(), power, 1e-9 * power);
}

TEST(ModelError, DoesNotFallWithTheNumberOfRows) {
  const Eigen::MatrixXd few = model_error(two_regressors(1000), 0.1), many = model_error(two_regressors(16000), 0.1);
  EXPECT_NEAR(many.row(1).norm(), few.row(1).norm(), 0.1 * few.row(1).norm());
}

TEST(ModelError, IsNoneWhereAllIsModelledOrNothingMoves) {
  estimation::RegressionData data = two_regressors(100);
  EXPECT_EQ(model_error(data, 0.0).norm(), 0.0);
  data.regressors.col(2).setZero();
  const Eigen::MatrixXd root = model_error(data, 0.1);
  EXPECT_TRUE(root.allFinite());
  EXPECT_EQ(root.row(2).norm(), 0.0);
  EXPECT_GT(root.row(1).norm(), 0.0);
}

}  // namespace
}  // namespace veridyn::aircraft
