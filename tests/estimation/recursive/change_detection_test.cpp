#include "veridyn/estimation/recursive/change_detection.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

TEST(Cusum, HasThePublishedRunLengths) {
  // Lucas & Crosier (1982), table 1: two-sided, reference 0.5.
  EXPECT_NEAR(cusum_run_length(0.5, 4.0), 168.0, 0.5);
  EXPECT_NEAR(cusum_run_length(0.5, 5.0), 465.0, 1.0);
  EXPECT_NEAR(cusum_run_length(0.5, 4.0, 1.0), 8.38, 0.01);
  EXPECT_NEAR(cusum_run_length(0.5, 5.0, 1.0), 10.4, 0.05);
}

TEST(Cusum, OfSquaresHasTheRunLengthOfASimulation) {
  std::mt19937_64 generator(2);
  std::normal_distribution<double> normal;
  const double reference = 1.46, threshold = 10.0;
  double total = 0.0;
  constexpr int kRuns = 4000;
  for (int run = 0; run < kRuns; ++run) {
    double sum = 0.0;
    int k = 0;
    while (sum <= threshold) {
      const double u = normal(generator);
      sum = std::max(0.0, sum + u * u - reference);
      ++k;
    }
    total += k;
  }
  // Run lengths are nearly exponential: relative standard error 1/sqrt(runs).
  const double expected = spread_cusum_run_length(reference, threshold);
  EXPECT_NEAR(total / kRuns, expected, 3.0 * expected / std::sqrt(kRuns));
}

// Alarms in `hours` of AR(1) noise at 100 Hz, and the time watched.
struct Watched {
  double alarms = 0.0;
  double time_s = 0.0;
};
Watched watch(double rho, double hours, const ChangeDetectionOptions& options, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  ChangeDetector detector(options);
  double state = 0.0;
  Watched result;
  const double fresh = std::sqrt(1.0 - rho * rho);
  for (int k = 0; k < static_cast<int>(hours * 360000.0); ++k) {
    state = rho * state + fresh * normal(generator);
    result.time_s += detector.watching() ? 0.01 : 0.0;
    result.alarms += detector.update(0.01 * k, state).has_value() ? 1.0 : 0.0;
  }
  return result;
}

class ChangeDetectorOnUnchangedNoise : public ::testing::TestWithParam<double> {};
TEST_P(ChangeDetectorOnUnchangedNoise, AlarmsNoMoreOftenThanStatedAndNotMuchLess) {
  const ChangeDetectionOptions options{.false_alarm_interval_s = 300.0};
  const Watched result = watch(GetParam(), 8.0, options, 11);
  const double expected = result.time_s / 300.0;
  // Stated is an upper limit: thresholds hold for what is known at the end of learning, and it is known better later.
  EXPECT_LT(result.alarms, expected + 3.0 * std::sqrt(expected));
  EXPECT_GT(result.alarms, 0.35 * expected - 3.0 * std::sqrt(0.35 * expected));
}
INSTANTIATE_TEST_SUITE_P(Colours, ChangeDetectorOnUnchangedNoise, ::testing::Values(0.0, 0.8, 0.95));

TEST(ChangeDetector, IsSilentForHoursWithTheDefaults) {
  EXPECT_EQ(watch(0.0, 2.0, {}, 3).alarms + watch(0.9, 2.0, {}, 4).alarms, 0.0);
}

TEST(ChangeDetector, SeesAJumpOfTheMeanAndSaysWhenItBegan) {
  std::mt19937_64 generator(6);
  std::normal_distribution<double> normal;
  ChangeDetector detector(ChangeDetectionOptions{});
  std::optional<Change> change;
  for (int k = 0; k < 20000 && !change; ++k) {
    const double shift = k >= 15000 ? -0.5 : 0.0;  // 2.2 deviations of a mean of 20
    change = detector.update(0.01 * k, normal(generator) + shift);
  }
  ASSERT_TRUE(change.has_value());
  EXPECT_EQ(change->kind, ChangeKind::kMean);
  EXPECT_LT(change->detected_s, 154.0);
  EXPECT_NEAR(change->began_s, 150.0, 1.0);
  EXPECT_NEAR(change->shift, -2.2, 0.8);
  EXPECT_TRUE(detector.watching());  // the noise is what it was
  EXPECT_EQ(detector.alarms(), 1u);
}

TEST(ChangeDetector, SeesADerivativeThatChangesThroughRegressorsThatSwing) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  ChangeDetector detector(ChangeDetectionOptions{});
  std::optional<Change> change;
  for (int k = 0; k < 30000 && !change; ++k) {
    const double wrong = k >= 20000 ? 1.5 * std::sin(0.05 * k) : 0.0;
    change = detector.update(0.01 * k, normal(generator) + wrong);
  }
  ASSERT_TRUE(change.has_value());
  EXPECT_EQ(change->kind, ChangeKind::kSpread);
  EXPECT_NEAR(change->began_s, 200.0, 1.0);
  EXPECT_LT(change->detected_s, 203.0);
}

TEST(ChangeDetector, SurvivesGapsAndNumbersThatAreNotFinite) {
  std::mt19937_64 generator(8);
  std::normal_distribution<double> normal;
  ChangeDetector detector(ChangeDetectionOptions{});
  for (int k = 0; k < 40000; ++k) {
    const double time = 0.01 * k + (k > 20000 ? 10.0 : 0.0);
    const double value = k % 1000 == 7 ? std::numeric_limits<double>::quiet_NaN() : normal(generator);
    EXPECT_FALSE(detector.update(time, value).has_value());
  }
  EXPECT_TRUE(std::isfinite(detector.suspicion()));
}

TEST(ChangeDetector, NamesTheOptionThatIsWrong) {
  try {
    ChangeDetector detector({.false_alarm_interval_s = 1.0});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "change_detection.false_alarm_interval_s: is 1; must be at least 20 blocks");
  }
}

}  // namespace
}  // namespace veridyn::estimation
