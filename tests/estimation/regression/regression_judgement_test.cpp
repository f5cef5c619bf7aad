#include "veridyn/estimation/regression/regression_judgement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::estimation {
namespace {

using testing_support::SimulationSettings;

Eigen::MatrixXd error_of_response(double sigma) {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(5, 5);
  W(4, 4) = sigma * sigma;
  return W;
}

const Eigen::VectorXd kTruth = (Eigen::VectorXd(4) << 1.0, -2.0, 0.5, 3.0).finished();

/// Made rows of a constant and three regressors, two of which move together; only the response has an error.
RegressionData made_rows(unsigned seed, const SimulationSettings& settings, double sigma = 1.0) {
  RegressionData data = testing_support::simulate_regression(seed, kTruth, error_of_response(sigma), settings).data;
  data.error_covariance.resize(0, 0);
  data.parameter_names = {"constant", "a", "b", "c"};
  return data;
}

JudgedRegression judged(RegressionData data, const JudgedRegressionOptions& options = {}) {
  Progress silent;
  return judged_regression(std::move(data), options, silent);
}

Evidence row_in(const JudgedRegression& result, Check check) {
  const auto row = std::ranges::find(result.estimate.evidence, check, &Evidence::check);
  return row == result.estimate.evidence.end() ? Evidence{} : *row;
}

TEST(RegressionJudgement, GradesAGoodTableYes) {
  const JudgedRegression result = judged(made_rows(1, {.rows = 600}));
  ASSERT_TRUE(result.chosen.has_value());
  EXPECT_EQ(result.groups.front().verdict, GroupVerdict::kIdentified) << result.estimate.verdict;
  EXPECT_EQ(result.estimate.judgement.parameters.grade, Grade::kYes);
  EXPECT_EQ(result.estimate.judgement.prediction.grade, Grade::kYes);
  EXPECT_GT(row_in(result, Check::kCrossValidation).value, 0.5);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(result.estimate.parameters[i].value, kTruth(i), 4.0 * result.estimate.parameters[i].sigma);
}

/// Share of intervals that hold the truth.
double coverage(const SimulationSettings& settings, unsigned sets) {
  double held = 0.0, all = 0.0;
  for (unsigned seed = 1; seed <= sets; ++seed) {
    const JudgedRegression result = judged(made_rows(seed, settings));
    for (std::size_t i = 0; i < 4; ++i) {
      const Parameter& p = result.estimate.parameters[i];
      const double truth = kTruth(i);
      held += p.low95 <= truth && truth <= p.high95 ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  return held / all;
}

// 800 intervals: a standard error of 0.008; those of one set are correlated, so twice that either side of 0.94 to 0.97.
TEST(RegressionJudgement, IntervalsHoldTheTruthWithWhiteAndColouredErrorsAndCollinearRegressors) {
  EXPECT_NEAR(coverage({.rows = 400}, 200), 0.955, 0.03);
  EXPECT_NEAR(coverage({.rows = 1000, .error_rho = 0.9}, 200), 0.955, 0.03);
}

TEST(RegressionJudgement, NamesRegressorsThatMoveTogether) {
  RegressionData data = made_rows(2, {.rows = 400});
  const RegressionData apart = made_rows(3, {.rows = 400});
  data.regressors.col(3) = data.regressors.col(1) + 1e-3 * apart.regressors.col(3);
  const JudgedRegression result = judged(std::move(data));
  const Evidence row = row_in(result, Check::kVarianceInflation);
  EXPECT_EQ(row.outcome, Outcome::kCare);
  EXPECT_EQ(std::get<std::string>(row.figure("names")->value), "a, c");
  EXPECT_NE(result.estimate.judgement.parameters.grade, Grade::kYes);
}

TEST(RegressionJudgement, SaysThatPartsContradictEachOther) {
  RegressionData data = made_rows(4, {.rows = 400});
  for (Eigen::Index i = 200; i < 400; ++i) data.regressand(i) += 5.0 * data.regressors(i, 1);
  const JudgedRegression result = judged(std::move(data));
  EXPECT_EQ(row_in(result, Check::kHalvesAgree).outcome, Outcome::kFailed);
  EXPECT_NE(result.groups.front().verdict, GroupVerdict::kIdentified);
}

TEST(RegressionJudgement, RowsThatExplainNothingPredictNothing) {
  RegressionData data = made_rows(5, {.rows = 300});
  data.regressand = made_rows(6, {.rows = 300, .error_rho = 0.0}, 100.0).regressand.reverse().eval();
  const JudgedRegression result = judged(std::move(data));
  EXPECT_EQ(row_in(result, Check::kCrossValidation).outcome, Outcome::kFailed);
  EXPECT_EQ(result.estimate.judgement.prediction.grade, Grade::kNo);
}

TEST(RegressionJudgement, LeavesOutIncompleteRowsAndChoosesTerms) {
  RegressionData data = made_rows(7, {.rows = 400});
  data.regressand(10) = std::nan("");
  const RegressionData other = made_rows(8, {.rows = 400});
  RowMatrix wide(400, 5);
  wide << data.regressors, other.regressors.col(2);
  data.regressors = wide;
  data.parameter_names.emplace_back("idle");
  const JudgedRegression result = judged(std::move(data), {.structure = StructureMethod::kStepwise});
  EXPECT_EQ(result.dropped, 1);
  ASSERT_TRUE(result.search.has_value());
  EXPECT_EQ(result.estimate.find("idle"), nullptr);
  EXPECT_NE(result.estimate.find("a"), nullptr);
}

TEST(RegressionJudgement, HasABootstrapAlongsideAndTheMethodThatIsAskedFor) {
  const JudgedRegression result = judged(made_rows(9, {.rows = 300}), {.method = Method::kTls, .bootstrap = 60});
  EXPECT_EQ(result.estimate.method, "TLS");
  EXPECT_EQ(result.groups.front().methods.back().method, "bootstrap of TLS");
  EXPECT_TRUE(result.groups.front().methods.back().usable);
}

}  // namespace
}  // namespace veridyn::estimation
