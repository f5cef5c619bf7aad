#include "veridyn/vehicle/identification/evidence/budget_conflicts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Cause;
using estimation::Outcome;
using ::testing::HasSubstr;

constexpr auto kDelay = DriveUnknown::kAccelYDelay;

/// What a fit finds of a delay with a normal prior where the drive alone would say `drive` +- `sigma`.
estimation::OutputErrorEstimate posterior(const DriveModelOptions& model, double drive, double sigma) {
  const double prior = std::pow(model.prior[kDelay], 2), noise = sigma * sigma;
  const auto i = static_cast<Eigen::Index>(kDelay);
  estimation::OutputErrorEstimate fit;
  fit.theta = Eigen::VectorXd::Zero(kDriveUnknowns);
  fit.covariance = Eigen::MatrixXd::Zero(kDriveUnknowns, kDriveUnknowns);
  fit.theta(i) = drive * prior / (prior + noise);
  fit.covariance(i, i) = prior * noise / (prior + noise);
  return fit;
}

// By chance prior and drive differ by sqrt(prior^2 + sigma^2); what a fit with the prior leaves says the same.
TEST(BudgetConflicts, AreWhatIsBeyondThreeStandardDeviationsOfTheDifference) {
  const DriveModelOptions model;
  for (const double sigma : {0.001, 0.01, 0.05}) {
    const double by_chance = std::hypot(model.prior[kDelay], sigma);
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_TRUE(budget_conflicts(model, posterior(model, sign * 2.99 * by_chance, sigma)).empty()) << sigma;
      const std::vector<BudgetConflict> found =
          budget_conflicts(model, posterior(model, sign * 3.01 * by_chance, sigma));
      ASSERT_EQ(found.size(), 1U) << sigma;
      EXPECT_EQ(found.front().unknown, kDelay);
      EXPECT_EQ(found.front().prior, model.prior[kDelay]);
    }
  }
}

TEST(BudgetConflicts, AreNotOfWhatIsKnownOrNotDetermined) {
  DriveModelOptions model;
  const estimation::OutputErrorEstimate fit = posterior(model, 0.1, 0.001);
  ASSERT_EQ(budget_conflicts(model, fit).size(), 1U);
  model.free[kDelay] = false;
  EXPECT_TRUE(budget_conflicts(model, fit).empty());
  model.free[kDelay] = true;
  model.prior[kDelay] = kInfinity;
  EXPECT_TRUE(budget_conflicts(model, fit).empty());
}

// A place or a trail far off stands for something that the model lacks.
TEST(BudgetConflicts, AreOfDelaysOnly) {
  const DriveModelOptions model;
  estimation::OutputErrorEstimate fit = posterior(model, 0.0, 0.001);
  for (const DriveUnknown u : {DriveUnknown::kAccelPlace, DriveUnknown::kTrail})
    fit.theta(static_cast<Eigen::Index>(u)) = 10.0;
  EXPECT_TRUE(budget_conflicts(model, fit).empty());
}

TEST(BudgetConflicts, WidenTheStrongestPriorAndNoOther) {
  const DriveModelOptions model;
  std::vector<BudgetConflict> found = budget_conflicts(model, posterior(model, -0.1, 0.001));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(strongest({}).has_value());
  found.push_back(
      {.unknown = DriveUnknown::kSteerDelay, .value = 0.11, .sigma = 0.001, .prior = 0.02, .by_chance = 0.02});
  EXPECT_EQ(strongest(found)->unknown, kDelay);
  const DriveModelOptions wide = with_widened_prior(model, found.front());
  EXPECT_NEAR(wide.prior[kDelay], 0.2, 0.004);
  for (const DriveUnknown u : kAllDriveUnknowns)
    if (u != kDelay && std::isfinite(model.prior[u])) EXPECT_EQ(wide.prior[u], model.prior[u]) << kDriveUnknownNames[u];
}

TEST(BudgetConflicts, KeepThePriorThatWasWidened) {
  DriveModelOptions model;
  const std::vector<BudgetConflict> before = budget_conflicts(model, posterior(model, 0.1, 0.001));
  model = with_widened_prior(model, before.front());
  const std::vector<BudgetConflict> now = conflicts_now(before, model, posterior(model, 0.1, 0.001));
  ASSERT_EQ(now.size(), 1U);
  EXPECT_EQ(now.front().prior, before.front().prior);
  EXPECT_NEAR(now.front().value, 0.1, 1e-4);
  EXPECT_GT(now.front().value, before.front().value);
}

TEST(BudgetConflicts, AreRowsThatNameTheChannel) {
  const auto row = [](DriveUnknown u, double value, double sigma) {
    return conflict_rows(std::vector<BudgetConflict>{{.unknown = u, .value = value, .sigma = sigma, .prior = 0.01}})
        .front();
  };
  EXPECT_EQ(row(kDelay, 0.034, 0.002).outcome, Outcome::kPassed) << "its own error counts";
  EXPECT_EQ(row(kDelay, -0.06, 0.001).outcome, Outcome::kCare);
  EXPECT_EQ(row(kDelay, 0.2, 0.001).outcome, Outcome::kFailed);
  const estimation::Evidence late = row(kDelay, 0.096, 0.002);
  EXPECT_EQ(late.about, "accel_y, yaw_rate");
  EXPECT_EQ(late.cause, Cause::kDelay);
  EXPECT_EQ(estimation::says(late),
            "accel_y_delay (how late accel_y is recorded against yaw_rate) is 0.096 +- 0.002 s, where 0 +- 0.01 s was "
            "expected: estimated with a prior twice as wide, and corrected");
  EXPECT_THAT(estimation::advice_of(late), HasSubstr("data.map takes its delay, \"96 ms\""));
  EXPECT_TRUE(conflict_rows(std::vector<BudgetConflict>{{.unknown = DriveUnknown::kSteerDelay}}).empty());
}

}  // namespace
}  // namespace veridyn::vehicle
