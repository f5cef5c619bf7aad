#include "veridyn/estimation/output_error/input_error_sizes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

/// Two outputs with noise of 0.2 and 0.7, errors of five samples each that are 1.5 times as large as their response
/// says, and errors of a kind that is not there.
ErrorResponse residual_with_errors() {
  constexpr Eigen::Index n = 300, kErrors = 60;
  numerics::RandomStream random(5, "errors");
  ErrorResponse s{.residual = RowMatrix(n, 2), .response = RowMatrix::Zero(2 * n, 2 * kErrors)};
  for (Eigen::Index c = 0; c < 2 * kErrors; ++c) s.kind_of.push_back(c < kErrors ? 0 : 1);
  for (Eigen::Index k = 0; k < n; ++k) {
    s.response(2 * k, k / 5) = s.response(2 * k + 1, k / 5) = 1.0;
    s.response(2 * k, kErrors + k / 5) = std::sin(static_cast<double>(k));
  }
  Eigen::VectorXd c(kErrors);
  for (double& value : c) value = 1.5 * random.normal();
  for (Eigen::Index k = 0; k < n; ++k) {
    s.residual(k, 0) = c(k / 5) + 0.2 * random.normal();
    s.residual(k, 1) = c(k / 5) + 0.7 * random.normal();
  }
  s.residual(7, 1) = std::nan("");
  return s;
}

TEST(InputErrorSizes, AreFoundBesideTheNoise) {
  const InputErrorSizes start{Eigen::VectorXd::Ones(2), Eigen::VectorXd::Ones(2)};
  const InputErrorSizes found = find_input_error_sizes({residual_with_errors()}, start, {.iterations = 40});
  // 300 values each: 4 % is one standard deviation of a standard deviation; of 60 errors 9 %.
  EXPECT_NEAR(found.noise(0), 0.2, 0.03);
  EXPECT_NEAR(found.noise(1), 0.7, 0.09);
  EXPECT_NEAR(found.factors(0), 1.5, 0.3);
  // The prior leaves what is not there some size.
  EXPECT_LT(found.factors(1), 0.4);
  EXPECT_GT(found.factors(1), 0.0);
}

TEST(InputErrorSizes, StayWhereTheyAreKnown) {
  const InputErrorSizes start{Eigen::VectorXd::Constant(2, 0.4), Eigen::VectorXd::Constant(2, 1.1)};
  const std::vector<ErrorResponse> segments{residual_with_errors()};
  const InputErrorSizes noise = find_input_error_sizes(segments, start, {.factors = false});
  EXPECT_EQ(noise.factors, start.factors);
  EXPECT_NE(noise.noise, start.noise);
  const InputErrorSizes factors = find_input_error_sizes(segments, start, {.noise = false});
  EXPECT_EQ(factors.noise, start.noise);
  EXPECT_NE(factors.factors, start.factors);
}

// Of few errors the prior decides.
TEST(InputErrorSizes, AStrongPriorKeepsThemAtOne) {
  const InputErrorSizes start{Eigen::VectorXd::Ones(2), Eigen::VectorXd::Ones(2)};
  const InputErrorSizes found =
      find_input_error_sizes({residual_with_errors()}, start, {.prior_errors = 1e5, .iterations = 40});
  EXPECT_NEAR(found.factors(0), 1.0, 0.01);
}

}  // namespace
}  // namespace veridyn::estimation
