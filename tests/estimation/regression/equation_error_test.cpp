#include "veridyn/estimation/regression/equation_error.hpp"

#include "tests/estimation/regression/correlated_errors.hpp"
#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/regression/total_least_squares.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"

namespace {
using namespace veridyn::estimation;
using testing_support::correlated_errors;
using testing_support::simulate_regression;
using testing_support::true_parameters;
namespace numerics = veridyn::numerics;

TEST(EquationError, GivesFullersClosedForm) {
  auto s = simulate_regression(11, true_parameters(), correlated_errors(0.5), {.rows = 4000});
  s.data.error_covariance(3, 4) = s.data.error_covariance(4, 3) = 0.0;
  s.data.error_covariance(4, 4) = 0.001;  // far too small: the rest is equation error
  s.data.regressand_error_known = false;
  const RegressionEstimate e = estimate(s.data, Method::kGtls);
  ASSERT_TRUE(e.usable());
  EXPECT_NEAR(e.error_scale, 1.0, 1e-9);
  // With the factor N - n_p that the error scale uses.
  const double N = static_cast<double>(s.data.rows()) - 4.0;
  const Eigen::MatrixXd M = numerics::transposed_product(s.data.regressors, s.data.regressors) -
                            N * s.data.error_covariance.topLeftCorner(4, 4);
  const Eigen::VectorXd right = numerics::transposed_product(s.data.regressors, s.data.regressand);
  EXPECT_LT((e.theta - numerics::solve_symmetric(M, right)).norm(), 1e-9);
}

// The other reading of a residual that is smaller than assumed: errors of the regressors are taken down, those of z and
// the correlation between them stay, until the residual is as large as W says.
TEST(EquationError, TakesTheErrorsOfTheRegressorsDownUntilTheResidualIsExplained) {
  const auto s = simulate_regression(12, true_parameters(), correlated_errors(0.1), {.rows = 4000});
  const Eigen::MatrixXd triangle = triangle_of(s.data), W = correlated_errors(0.4);
  const auto scale = [&](const Eigen::MatrixXd& of) { return total_least_squares(triangle, of, 4000.0).error_scale; };
  ASSERT_LT(scale(W), 0.9);
  const Eigen::MatrixXd less = with_smaller_regressor_errors(triangle, W, 4000.0);
  EXPECT_NEAR(scale(less), 1.0, 1e-9);
  EXPECT_EQ(less(4, 4), W(4, 4));
  // Errors were made with half the standard deviations: f = 1/2, and the correlation stays.
  EXPECT_NEAR(less(1, 1) / W(1, 1), 0.25, 0.05);
  EXPECT_NEAR(less(3, 4) / std::sqrt(less(3, 3)), W(3, 4) / std::sqrt(W(3, 3)), 1e-12);
  // Exact regressors leave even more: nothing of the regressors is left.
  Eigen::MatrixXd noisy = W;
  noisy(4, 4) = 100.0;
  EXPECT_EQ(with_smaller_regressor_errors(triangle, noisy, 4000.0).topLeftCorner(4, 4).norm(), 0.0);
  // And what is explained is left alone.
  const Eigen::MatrixXd small = 0.1 * W;
  EXPECT_EQ(with_smaller_regressor_errors(triangle, small, 4000.0), small);
}

}  // namespace
