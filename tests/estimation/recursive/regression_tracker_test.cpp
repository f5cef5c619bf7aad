#include "veridyn/estimation/recursive/regression_tracker.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/support/refusal.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::estimation {
namespace {

TrackerOptions tracker_options_of(const std::string& keys) {
  const Study study = Study::parse("[track]\n" + keys, "study.toml");
  return TrackerOptions::keys().read(study.root().table("track"));
}

TEST(TrackerOptions, AMemoryIsTheTimeAfterWhichARowCountsFivePercent) {
  const ForgettingOptions of_memory = tracker_options_of("memory = 40").forgetting_at(20.0);
  EXPECT_NEAR(std::pow(of_memory.square_weight(), 40.0 * 20.0), 0.05, 1e-12);
  EXPECT_LE(of_memory.lambda_min, of_memory.lambda);
  EXPECT_EQ(tracker_options_of("lambda = 0.9995").forgetting_at(20.0).lambda, 0.9995);
  // A short memory takes the least value down with it.
  EXPECT_LE(tracker_options_of("memory = 1").forgetting_at(20.0).lambda_min, std::pow(0.05, 1.0 / 20.0));
}

TEST(TrackerOptions, RefuseWithLineAndKey) {
  EXPECT_EQ(why([] { (void)tracker_options_of("lambda = 0.999\nmemory = 40"); }),
            "study.toml:3: track.memory: and lambda say the same thing; give one of them");
  EXPECT_NE(why([] { (void)tracker_options_of("signal_to_noise = 0.5"); }).find("must be from 1 to 10"),
            std::string::npos);
  EXPECT_NE(why([] { (void)tracker_options_of("method = \"TLS\""); }).find("study.toml:2: track.method"),
            std::string::npos);
}

// Against the sums over all rows under their weights.
TEST(TrackedPower, IsThatOfTheWeightedRows) {
  const std::vector<double> z{1.0, -2.0, 0.5, 4.0, 3.0, -1.0}, e{0.0, 0.3, -0.2, 0.5, 0.1, -0.4},
      lambda{0.9, 0.9, 0.7, 0.9, 0.8, 0.95};
  TrackedPower power;
  double weights = 0.0, sum = 0.0, squares = 0.0, lagged = 0.0;
  std::vector<double> weight;
  for (std::size_t k = 0; k < z.size(); ++k) {
    power.add(z[k], lambda[k]);
    power.add_innovation(e[k], k > 0 ? e[k - 1] : 0.0, lambda[k]);
    for (double& w : weight) w *= lambda[k];
    weight.push_back(1.0);
  }
  for (std::size_t k = 0; k < z.size(); ++k) {
    weights += weight[k];
    sum += weight[k] * z[k];
    squares += weight[k] * e[k] * e[k];
    if (k > 0) lagged += weight[k] * e[k] * e[k - 1];
  }
  double deviation = 0.0;
  for (std::size_t k = 0; k < z.size(); ++k) deviation += weight[k] * std::pow(z[k] - sum / weights, 2);
  EXPECT_NEAR(power.mean, sum / weights, 1e-14);
  EXPECT_NEAR(power.deviation, deviation, 1e-13);
  EXPECT_NEAR(power.predicted_share(), 1.0 - squares / deviation, 1e-14);
  EXPECT_NEAR(power.lag1(), lagged / squares, 1e-14);
}

constexpr double kTrackedRate_Hz = 20.0;

RegressionTracker plain_tracker() {
  Eigen::MatrixXd W = 0.0025 * Eigen::MatrixXd::Identity(3, 3);
  W(0, 0) = 0.0;
  TrackerOptions options;
  options.forgetting.variable = false;
  options.detect_changes = false;
  return {{"one", "a"}, W, options, kTrackedRate_Hz};
}

/// Rows of z = 0.1 + a x with the noise that the tracker expects, from a row on.
void track(RegressionTracker& tracker, double a, int first, int rows) {
  std::mt19937_64 generator(static_cast<unsigned>(first + 1));
  std::normal_distribution<double> normal(0.0, 0.05);
  for (int k = first; k < first + rows; ++k) {
    const double t = k / kTrackedRate_Hz, x = std::sin(2.0 * t) + 0.5 * std::sin(5.3 * t + 1.0);
    (void)tracker.update(t, std::array{1.0, x + normal(generator)}, 0.1 + a * x + normal(generator));
  }
}

TEST(RegressionTracker, KeepsItsHistoryAtItsOwnRate) {
  RegressionTracker tracker = plain_tracker();
  track(tracker, 1.0, 0, 1997);  // the last row is one that is kept
  const TrackHistory& h = tracker.history();
  ASSERT_EQ(h.time.size(), 500U);  // 100 s at 5 Hz
  for (std::size_t k = 1; k < h.time.size(); ++k) EXPECT_NEAR(h.time[k] - h.time[k - 1], 0.2, 1e-9);
  ASSERT_EQ(h.value.size(), 2U);
  EXPECT_EQ(h.value[1].size(), 500U);
  EXPECT_EQ(h.value[1].back(), tracker.regression().theta()(1));
  // Four innovations over their standard deviation each: their mean square is 1.
  double power = 0.0;
  for (std::size_t k = 100; k < 500; ++k) power += h.innovation[k] * h.innovation[k] / 400.0;
  EXPECT_NEAR(power, 1.0, 0.15);
}

// A change that is known to have happened is followed at once; without being told the memory has to pass.
TEST(RegressionTracker, RestartForgetsTheRowsAndKeepsTheEstimate) {
  RegressionTracker told = plain_tracker();
  track(told, 1.0, 0, 8000);
  EXPECT_GE(told.scatter().parts, 2);
  RegressionTracker untold = told;
  const double before = told.regression().theta()(1);
  EXPECT_NEAR(before, 1.0, 0.02);
  told.restart(Eigen::Vector2d(1.0, 1.0));
  EXPECT_NEAR(told.regression().theta()(1), before, 1e-12);
  EXPECT_EQ(told.scatter().parts, 0);
  for (RegressionTracker* tracker : {&told, &untold}) track(*tracker, 2.0, 8000, 200);
  EXPECT_NEAR(told.regression().theta()(1), 2.0, 0.05);
  EXPECT_LT(untold.regression().theta()(1), 1.7);
  EXPECT_EQ(told.history().time, untold.history().time);
}

}  // namespace
}  // namespace veridyn::estimation
