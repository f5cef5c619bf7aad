#include "veridyn/estimation/recursive/tracking_evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/judgement.hpp"
#include "veridyn/estimation/regression/regression_evidence.hpp"

namespace veridyn::estimation {
namespace {

constexpr double kRowRate_Hz = 20.0;

/// What may be wrong with a tracked regression z = 0.1 + a x + 0.5 y + e, noise 0.05 on x, y and z.
struct Drift {
  double noise = 0.05;       ///< of z, where W says 0.05
  double end_slope = 1.0;    ///< a goes there from 1 over the recording
  double y_moves = 1.0;      ///< amplitude of y
  double y_follows_x = 0.0;  ///< y moves as x but for this share
  double quadratic = 0.0;    ///< a term that the model lacks
  double share_of_z = 1.0;   ///< of the model in z
  bool detect = false;       ///< changes are looked for
  double jump_s = 1e9;       ///< when a halves
  double noise_rho = 0.0;    ///< correlation of the noise of z from row to row
};

RegressionTracker tracked_regression(const Drift& d, double duration_s = 400.0, unsigned seed = 1) {
  Eigen::MatrixXd W = 0.0025 * Eigen::MatrixXd::Identity(4, 4);
  W(0, 0) = 0.0;
  TrackerOptions options;
  options.detect_changes = d.detect;
  RegressionTracker tracker({"one", "a", "b"}, W, options, kRowRate_Hz);
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  double noise = 0.0;
  const int rows = static_cast<int>(duration_s * kRowRate_Hz);
  for (int k = 0; k < rows; ++k) {
    const double t = k / kRowRate_Hz;
    const double x = std::sin(2.0 * t) + 0.5 * std::sin(5.3 * t + 1.0);
    const double y = d.y_moves * (d.y_follows_x * x + (1.0 - d.y_follows_x) * std::sin(3.1 * t + 0.4));
    const double slope = t < d.jump_s ? 1.0 + (d.end_slope - 1.0) * t / duration_s : 0.5;
    noise = d.noise_rho * noise + std::sqrt(1.0 - d.noise_rho * d.noise_rho) * normal(generator);
    const double z = d.share_of_z * (0.1 + slope * x + 0.5 * y) + d.quadratic * x * x + d.noise * noise;
    const std::array<double, 3> row{1.0, x + 0.05 * normal(generator), y + 0.05 * normal(generator)};
    (void)tracker.update(t, row, z);
    if (k % 200 == 0) tracker.fit_equation_error();
  }
  return tracker;
}

std::vector<Evidence> tracking_rows(const RegressionTracker& tracker) {
  return tracking_evidence("C", tracker, tracker.estimate());
}

Evidence tracking_row(const RegressionTracker& tracker, Check check) {
  const std::vector<Evidence> rows = tracking_rows(tracker);
  const auto found = std::ranges::find(rows, check, &Evidence::check);
  if (found == rows.end()) throw std::logic_error("no row " + std::string(to_string(check)));
  return *found;
}

TEST(TrackingEvidence, LetsARegressionPassThatIsAsItsNoiseSays) {
  const RegressionTracker tracker = tracked_regression({});
  for (const Evidence& row : tracking_rows(tracker)) {
    EXPECT_TRUE(row.passed()) << name_of(row) << ": " << says(row);
    EXPECT_EQ(row.about, "C");
  }
  const Judgement j = judge(tracking_rows(tracker));
  EXPECT_EQ(j.parameters.grade, Grade::kYes);
  EXPECT_EQ(j.prediction.grade, Grade::kYes);
  EXPECT_NEAR(tracker.error_ratio(), 1.0, 0.3);
}

TEST(TrackingEvidence, FindsAResidualBeyondTheSensors) {
  EXPECT_EQ(tracking_row(tracked_regression({.noise = 0.25}), Check::kResidualBeyondSensors).outcome, Outcome::kCare);
  // A term that the model lacks carries much of the variance.
  const Evidence row = tracking_row(tracked_regression({.quadratic = 1.0}), Check::kUnmodelledShare);
  EXPECT_EQ(row.outcome, Outcome::kFailed) << says(row);
}

TEST(TrackingEvidence, SaysWhatIsHeld) {
  const Evidence row = tracking_row(tracked_regression({.y_moves = 0.0}), Check::kTrackedExcitation);
  EXPECT_EQ(row.outcome, Outcome::kCare);
  EXPECT_EQ(row.cause, Cause::kExcitation);
  EXPECT_NE(says(row).find("b"), std::string::npos) << says(row);
}

TEST(TrackingEvidence, NamesRegressorsThatMoveTogether) {
  // With more than sensor noise in the residual collinearity matters.
  const Evidence row = tracking_row(tracked_regression({.noise = 0.25, .y_follows_x = 0.8}), Check::kVarianceInflation);
  EXPECT_EQ(row.outcome, Outcome::kCare) << says(row);
  EXPECT_EQ(row.cause, Cause::kCollinear);
  EXPECT_EQ(std::get<std::string>(row.figure("names")->value), "a, b");
  const Evidence quiet = tracking_row(tracked_regression({.y_follows_x = 0.8}), Check::kVarianceInflation);
  EXPECT_EQ(quiet.outcome, Outcome::kPassed) << says(quiet);
  EXPECT_EQ(quiet.cause, Cause::kCollinear) << "known, but the residual is no larger than sensor noise";
}

TEST(TrackingEvidence, SaysThatNeighbouringRowsCorrelate) {
  const Evidence row = tracking_row(tracked_regression({.noise_rho = 0.8}), Check::kInnovationCorrelation);
  EXPECT_EQ(row.outcome, Outcome::kCare) << says(row);
  EXPECT_GT(row.value, 0.2);
  EXPECT_TRUE(row.bears_on.empty()) << "the error bars allow for it";
}

TEST(TrackingEvidence, SaysWhichChangesWereFound) {
  const Evidence none = tracking_row(tracked_regression({.detect = true}), Check::kChanges);
  EXPECT_EQ(none.outcome, Outcome::kPassed) << says(none);
  const RegressionTracker tracker = tracked_regression({.detect = true, .jump_s = 250.0});
  const Evidence row = tracking_row(tracker, Check::kChanges);
  EXPECT_EQ(row.outcome, Outcome::kCare) << says(row);
  ASSERT_FALSE(tracker.changes().empty());
  EXPECT_NEAR(tracker.changes().front().detected_s, 250.0, 10.0);
  EXPECT_EQ(judge(tracking_rows(tracker)).parameters.grade, Grade::kWithCare);
  EXPECT_EQ(tracking_row(tracked_regression({}, 100.0), Check::kChanges).outcome, Outcome::kNotVerified)
      << "they were not looked for";
}

TEST(TrackingEvidence, IsMissingBeforeThereIsAnEstimate) {
  const RegressionTracker tracker = tracked_regression({}, 0.1);
  const std::vector<Evidence> rows = tracking_rows(tracker);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows.front().check, Check::kTrackedEstimate);
  EXPECT_EQ(rows.front().outcome, Outcome::kMissing);
  EXPECT_EQ(judge(rows).parameters.grade, Grade::kNotJudged);
  EXPECT_EQ(judge(rows).prediction.grade, Grade::kNotJudged);
}

TEST(TrackingEvidence, RefusesAParameterWithoutAStandardError) {
  const RegressionTracker tracker = tracked_regression({}, 100.0);
  const auto failed = [&](double sigma, ParameterStatus status) {
    RegressionEstimate estimate = tracker.estimate();
    estimate.parameters[1].sigma = sigma;
    estimate.parameters[1].status = status;
    const std::vector<Evidence> rows = tracking_evidence("C", tracker, estimate);
    return std::ranges::count_if(rows, [](const Evidence& row) {
      return row.check == Check::kStandardError && row.outcome == Outcome::kFailed;
    });
  };
  EXPECT_EQ(failed(0.01, ParameterStatus::kIdentified), 0);
  EXPECT_EQ(failed(0.0, ParameterStatus::kIdentified), 1);
  EXPECT_EQ(failed(std::nan(""), ParameterStatus::kIdentified), 1);
  EXPECT_EQ(failed(0.0, ParameterStatus::kFixed), 0) << "it was given";
}

TEST(TrackingEvidence, FindsParametersThatDrift) {
  const RegressionTracker tracker = tracked_regression({.end_slope = 0.6});
  const Evidence row = tracking_row(tracker, Check::kTrackedParts);
  EXPECT_EQ(row.outcome, Outcome::kFailed) << says(row);
  // What is not constant gets the interval that its scatter shows.
  EXPECT_GT(tracker.estimate().parameters[1].sigma, 3.0 * tracker.regression().sigma()(1));
}

TEST(TrackingEvidence, CannotCompareWhatIsShorterThanTwoMemories) {
  EXPECT_EQ(tracking_row(tracked_regression({}, 150.0), Check::kTrackedParts).outcome, Outcome::kNotVerified);
}

TEST(TrackingEvidence, DoesNotCallAPredictionWhatPredictsNothing) {
  const Evidence row = tracking_row(tracked_regression({.noise = 0.4, .share_of_z = 0.1}), Check::kNextRow);
  EXPECT_EQ(row.outcome, Outcome::kFailed) << says(row);
}

/// Rows that are less than passed, and bear on something, in so many clean recordings.
int false_alarms(unsigned recordings) {
  int alarms = 0;
  for (unsigned seed = 1; seed <= recordings; ++seed) {
    const RegressionTracker tracker = tracked_regression({}, 330.0, seed);
    for (const Evidence& row : tracking_rows(tracker)) alarms += !row.passed() && !row.bears_on.empty();
  }
  return alarms;
}

// Stated: at most 2 of 100 recordings with a row that is less than passed. At that rate 25 recordings have two of them
// with a probability of 9 %, at five times that rate with one of 73 %.
TEST(TrackingEvidence, RaisesFewAlarmsOnCleanRecordings) { EXPECT_LE(false_alarms(25), 1); }

TEST(TrackingEvidenceSoak, RaisesFewAlarmsOnAHundredCleanRecordings) { EXPECT_LE(false_alarms(100), 2); }

TEST(RegressionTracker, TakesWhatWDoesNotExplainForErrorOfTheEquation) {
  // GTLS that takes noise of z for noise of the regressors overcorrects the slope.
  Eigen::MatrixXd W = 0.0025 * Eigen::MatrixXd::Identity(3, 3);
  W(0, 0) = 0.0;
  W(1, 1) = 0.04;
  TrackerOptions options;
  options.method = Method::kGtls;
  options.memory_s = 1000.0;
  double with = 0.0, without = 0.0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    RegressionTracker fitted({"one", "a"}, W, options, kRowRate_Hz), plain({"one", "a"}, W, options, kRowRate_Hz);
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 8000; ++k) {
      const double x = std::sin(0.1 * k);
      const double z = 0.1 + x + 0.4 * normal(generator);
      const std::array<double, 2> row{1.0, x + 0.2 * normal(generator)};
      (void)fitted.update(k / kRowRate_Hz, row, z);
      (void)plain.update(k / kRowRate_Hz, row, z);
      if (k % 200 == 199) fitted.fit_equation_error();
    }
    with += 0.1 * fitted.regression().theta()(1);
    without += 0.1 * plain.regression().theta()(1);
    // var z = 0.16 where W says 0.0025.
    EXPECT_NEAR(fitted.equation_error(), 0.16 - 0.0025, 0.03);
    EXPECT_NEAR(plain.error_ratio(), fitted.error_ratio(), 1.5);
  }
  EXPECT_GT(without, 1.1);
  // Ten slopes of standard error 0.45/sqrt(8000/2)/... about 0.008 each.
  EXPECT_NEAR(with, 1.0, 0.02);
}

}  // namespace
}  // namespace veridyn::estimation
