#include "veridyn/estimation/judgement/agreement.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace veridyn::estimation {
namespace {

// Chi-square of two degrees of freedom: p = exp(-chi^2/2).
TEST(Agreement, OfTwoParametersIsTheClosedForm) {
  Eigen::Matrix2d covariance;
  covariance << 4.0, 1.0, 1.0, 9.0;
  const Eigen::Vector2d difference(3.0, -2.0);
  const double chi_square = difference.dot(covariance.inverse() * difference);
  EXPECT_NEAR(agreement_p(difference, covariance), std::exp(-0.5 * chi_square), 1e-12);
  EXPECT_NEAR(agreement(difference, covariance).ratio, 0.5 * chi_square, 1e-12);
}

TEST(Agreement, DoesNotDependOnUnits) {
  Eigen::Matrix2d covariance;
  covariance << 4.0, 1.0, 1.0, 9.0;
  const Eigen::Vector2d difference(3.0, -2.0), unit(1e-6, 1e9);
  EXPECT_NEAR(agreement_p(unit.cwiseProduct(difference), unit.asDiagonal() * covariance * unit.asDiagonal()),
              agreement_p(difference, covariance), 1e-12);
}

TEST(Agreement, SaysNothingWithoutErrorBars) {
  const Eigen::Vector2d difference(3.0, -2.0);
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  covariance(1, 1) = 0.0;
  EXPECT_EQ(agreement_p(difference, covariance), 1.0);
  covariance(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(agreement_p(difference, covariance), 1.0);
  for (const Eigen::Index i : {0, 1}) {
    covariance = Eigen::Matrix2d::Identity();
    covariance(i, i) = -1.0;
    EXPECT_EQ(agreement_p(difference, covariance), 1.0) << i;
  }
}

}  // namespace
}  // namespace veridyn::estimation
