#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/estimation/regression/four_parameters.hpp"
#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/regression/regression_evidence.hpp"

namespace {
using namespace veridyn::estimation;
using testing_support::correlated_noise;
using testing_support::errors;
using testing_support::regression_theta;
using testing_support::simulate_regression;

/// Rows of `s` with a fifth regressor, 0.5 + 0.5 of the first's two: as the piece of a polyline whose knot is never
/// passed.
RegressionData with_dependent_column(const RegressionData& s) {
  RegressionData data = s;
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(5, 6);
  T.topLeftCorner(4, 4).setIdentity();
  T(0, 4) = T(1, 4) = 0.5;
  T(4, 5) = 1.0;
  data.regressors = s.regressors * T.topLeftCorner(4, 5);
  data.error_covariance = T.transpose() * s.error_covariance * T;
  data.parameter_names.emplace_back("theta4");
  return data;
}

/// The row of a check, which must be there.
Evidence row_in(const RegressionComparison& c, Check check) {
  const auto row = std::ranges::find(c.checks, check, &Evidence::check);
  if (row == c.checks.end()) throw std::logic_error("no row " + std::string(to_string(check)));
  return *row;
}

Evidence collinearity_in(const RegressionComparison& c) { return collinearity(*c.examined_estimate()); }

TEST(Compare, RecommendsGtlsWhenItsAssumptionsHold) {
  const auto s = simulate_regression(1, regression_theta(), errors(0.1, 0.1));
  const RegressionComparison c = compare(s.data);
  ASSERT_EQ(c.estimates.size(), 4U);
  ASSERT_TRUE(c.recommends) << c.reason;
  EXPECT_EQ(c.recommended, Method::kGtls);
  EXPECT_EQ(c.best(), c.find(Method::kGtls));
  EXPECT_NEAR(c.best()->error_scale, 1.0, 0.15);
  EXPECT_THAT(c.reason, testing::HasSubstr("as large as the assumed errors say"));
}

TEST(Compare, RecommendsOlsWithExactRegressors) {
  const auto s = simulate_regression(2, regression_theta(), errors(0.0, 0.1));
  const RegressionComparison c = compare(s.data);
  ASSERT_TRUE(c.recommends);
  EXPECT_EQ(c.recommended, Method::kOls);
}

// The trap of the specification: with a wrong ratio of errors GTLS is far worse than OLS. Here the regressors are
// nearly exact, the model lacks a term, and W says that the errors are the regressors'.
TEST(Compare, RefusesWhenTheErrorRatioIsWrongAndMatters) {
  auto s = simulate_regression(3, regression_theta(), errors(1e-4, 1.0));
  s.data.error_covariance = errors(0.05, 0.01);
  const RegressionComparison c = compare(s.data);
  const Eigen::VectorXd wrong = c.find(Method::kGtls)->theta;
  ASSERT_GT((wrong - regression_theta()).norm(), 4.0 * (c.find(Method::kOls)->theta - regression_theta()).norm());
  EXPECT_FALSE(c.recommends) << c.reason;
  EXPECT_EQ(c.best(), nullptr);
  EXPECT_THAT(c.reason, testing::HasSubstr("none: the residual variance is"));
}

// The same errors of the regressors, but what is left unexplained is declared to be error of the equation.
TEST(Compare, EstimatesEquationErrorWhenAsked) {
  auto s = simulate_regression(4, regression_theta(), errors(0.05, 1.0), {.rows = 8000});
  s.data.error_covariance(4, 4) = 0.01;
  EXPECT_FALSE(compare(s.data).recommends);
  s.data.regressand_error_known = false;
  const RegressionComparison c = compare(s.data);
  ASSERT_TRUE(c.recommends) << c.reason;
  EXPECT_EQ(c.recommended, Method::kGtls);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Parameter& p = c.best()->parameters[i];
    EXPECT_NEAR(p.value, regression_theta()(i), 3.5 * p.sigma);
  }
}

TEST(Compare, TakesPcaWhenADirectionIsNotExcited) {
  auto s = simulate_regression(5, regression_theta(), errors(0.02, 0.02));
  std::mt19937_64 generator(77);
  const Eigen::VectorXd noise = correlated_noise(generator, s.data.rows(), 0.0);
  s.data.regressors.col(3) = noise * std::sqrt(0.02);
  s.data.regressand -= -1.2 * s.true_regressors.col(3);
  const RegressionComparison c = compare(s.data);
  ASSERT_TRUE(c.recommends) << c.reason;
  EXPECT_EQ(c.recommended, Method::kPcaGtls);
  EXPECT_EQ(c.best()->find("theta3")->status, ParameterStatus::kNotExcited);
  EXPECT_EQ(c.best()->find("theta1")->status, ParameterStatus::kIdentified);
}

// One exact dependency is held. Whether the residual is as large as assumed is then judged by what is estimated: three
// times too large errors of the regressors were a refusal ("moves inf sigma").
TEST(Compare, JudgesWhatIsEstimatedWhereADirectionIsHeld) {
  auto s = simulate_regression(5, regression_theta(), errors(0.001, 0.001));
  s.data.error_covariance *= 10.0;
  const RegressionComparison c = compare(with_dependent_column(s.data));
  ASSERT_TRUE(c.recommends) << c.reason;
  EXPECT_EQ(c.recommended, Method::kPcaGtls);
  ASSERT_EQ(c.best()->unexcited.size(), 1u);
  EXPECT_NEAR(c.best()->find("theta2")->value, regression_theta()(2), 0.01);
  EXPECT_TRUE(collinearity_in(c).passed()) << says(collinearity_in(c));
}

// What moves together beside it is still named, and nothing else.
TEST(Compare, NamesCollinearRegressorsBesideADirectionThatIsHeld) {
  auto s = simulate_regression(5, regression_theta(), errors(0.001, 0.001));
  const Eigen::VectorXd before = s.data.regressors.col(3);
  s.data.regressors.col(3) = s.data.regressors.col(2) + 0.15 * before;
  s.data.regressand += regression_theta()(3) * (s.data.regressors.col(3) - before);
  const RegressionComparison c = compare(with_dependent_column(s.data));
  const Evidence row = collinearity_in(c);
  EXPECT_FALSE(row.passed());
  EXPECT_EQ(std::get<std::string>(row.figure("names")->value), "theta2, theta3");
}

// Noise as W says, small enough that OLS is as good.
TEST(CompareRows, LetARegressionPassThatIsAsItsNoiseSays) {
  int autocorrelated = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const RegressionComparison c = compare(simulate_regression(seed, regression_theta(), errors(1e-3, 0.01)).data);
    for (const Check check : {Check::kOlsAgreement, Check::kErrorScale, Check::kErrorRatioSensitivity})
      EXPECT_EQ(row_in(c, check).outcome, Outcome::kPassed) << says(row_in(c, check));
    EXPECT_EQ(collinearity_in(c).outcome, Outcome::kPassed) << says(collinearity_in(c));
    autocorrelated += row_in(c, Check::kResidualAutocorrelation).passed() ? 0 : 1;
    EXPECT_EQ(c.checks.size(), 4U);
  }
  // A test at 5 %, for information: more than six of 40 in 1 % of all cases.
  EXPECT_LE(autocorrelated, 6);
}

TEST(CompareRows, FindAResidualThatIsCorrelated) {
  const auto row = [](double rho) {
    return row_in(compare(simulate_regression(1, regression_theta(), errors(0.0, 0.01), {.error_rho = rho}).data),
                  Check::kResidualAutocorrelation);
  };
  EXPECT_EQ(row(0.0).outcome, Outcome::kPassed) << says(row(0.0));
  EXPECT_EQ(row(0.9).outcome, Outcome::kCare);
  EXPECT_NEAR(std::get<double>(row(0.9).figure("durbin_watson")->value), 2.0 * (1.0 - 0.9), 0.1)
      << "Durbin-Watson of a first-order process";
  // The error bars are wide enough, so that no grade depends on it.
  EXPECT_TRUE(row(0.9).bears_on.empty());
}

// Regressors with a tenth of their variance in noise: OLS is attenuated, by many of its error bars.
TEST(CompareRows, SayThatOlsIsBiasedByNoiseOfTheRegressors) {
  const Evidence row =
      row_in(compare(simulate_regression(1, regression_theta(), errors(0.1, 0.1)).data), Check::kOlsAgreement);
  EXPECT_EQ(row.outcome, Outcome::kCare);
  EXPECT_GT(row.value, 5.0);
}

TEST(CompareRows, CompareTheResidualWithTheAssumedErrors) {
  const auto with = [](double factor) {
    auto s = simulate_regression(1, regression_theta(), errors(1e-3, 0.01));
    s.data.error_covariance *= factor;
    return compare(s.data);
  };
  // Standard deviations are known to a factor of two.
  for (const double factor : {0.3, 1.0, 3.4})
    EXPECT_EQ(row_in(with(factor), Check::kErrorScale).outcome, Outcome::kPassed) << factor;
  for (const double factor : {0.2, 5.0}) {
    const Evidence row = row_in(with(factor), Check::kErrorScale);
    EXPECT_EQ(row.outcome, Outcome::kCare) << factor;
    EXPECT_NEAR(row.value, 1.0 / factor, 0.15 / factor);
    // All errors by the same factor leave their ratio, so that the estimate stays and a method is recommended.
    EXPECT_EQ(row_in(with(factor), Check::kErrorRatioSensitivity).outcome, Outcome::kPassed) << factor;
    EXPECT_TRUE(with(factor).recommends) << with(factor).reason;
  }
}

// The trap of above: which error the difference is matters by many sigmas.
TEST(CompareRows, SayThatTheEstimateDependsOnTheErrorRatio) {
  auto s = simulate_regression(3, regression_theta(), errors(1e-4, 1.0));
  s.data.error_covariance = errors(0.05, 0.01);
  const Evidence row = row_in(compare(s.data), Check::kErrorRatioSensitivity);
  EXPECT_EQ(row.outcome, Outcome::kCare);
  EXPECT_GT(row.value, row.limit);
  EXPECT_EQ(row.cause, Cause::kMissingTerm);
}

TEST(CompareRows, NameRegressorsThatMoveTogether) {
  auto s = simulate_regression(5, regression_theta(), errors(0.0, 0.01));
  EXPECT_EQ(collinearity_in(compare(s.data)).outcome, Outcome::kPassed);
  s.data.regressors.col(3) = s.data.regressors.col(2) + 0.15 * s.data.regressors.col(3);
  s.data.regressand = s.data.regressors * regression_theta();
  const Evidence row = collinearity_in(compare(s.data));
  EXPECT_EQ(row.outcome, Outcome::kCare);
  // 1/(1 - R^2) of theta3, whose own part has 0.15^2 of theta2's variance.
  EXPECT_THAT(says(row), testing::HasSubstr("theta2, theta3 move together"));
  EXPECT_TRUE(row.bears_on.contains(Purpose::kParameters));
  EXPECT_FALSE(row.bears_on.contains(Purpose::kPrediction));
}

// Condition number with two columns that differ by a share d: 2/d.
TEST(Collinearity, IsWithCareAndFailsByTheConditionNumber) {
  const auto row = [](double own, bool noise_alone = false) {
    auto s = simulate_regression(5, regression_theta(), errors(0.0, 0.01));
    s.data.regressors.col(3) = s.data.regressors.col(2) + own * s.data.regressors.col(3);
    return collinearity(*compare(s.data).examined_estimate(), noise_alone);
  };
  EXPECT_EQ(row(1e-3).check, Check::kVarianceInflation);
  EXPECT_EQ(row(1e-3).outcome, Outcome::kCare);
  EXPECT_EQ(row(1e-3, true).outcome, Outcome::kPassed) << "wide intervals hold";
  const Evidence failed = row(1e-5);
  EXPECT_EQ(failed.check, Check::kCollinearity);
  EXPECT_EQ(failed.outcome, Outcome::kFailed);
  EXPECT_EQ(failed.limit, 1e4);
  EXPECT_THAT(says(failed), testing::HasSubstr("theta2, theta3"));
  EXPECT_EQ(row(1e-5, true).outcome, Outcome::kFailed) << "no sensor resolves that";
}

TEST(Compare, MarksInsignificantParametersWithoutZeroingThem) {
  Eigen::VectorXd theta = regression_theta();
  theta(3) = 0.0;
  const auto s = simulate_regression(6, theta, errors(0.1, 0.1));
  RegressionEstimate e = estimate(s.data, Method::kGtls);
  EXPECT_EQ(e.parameters[3].status, ParameterStatus::kInsignificant);
  EXPECT_NE(e.theta(3), 0.0);
  EXPECT_EQ(e.parameters[1].status, ParameterStatus::kIdentified);
}

}  // namespace
