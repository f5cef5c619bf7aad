#include "veridyn/estimation/kalman/innovation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {
namespace {

TEST(InnovationMonitor, FindsWhiteInnovationsConsistent) {
  numerics::RandomStream random(1, "white");
  InnovationMonitor monitor;
  double log_likelihood = 0.0;
  std::vector<double> e;
  for (int i = 0; i < 20000; ++i) {
    const double S = random.uniform(0.5, 2.0);
    const double nu = std::sqrt(S) * random.normal();
    ASSERT_TRUE(monitor.judge(0.01 * i, nu, S).accept);
    e.push_back(nu / std::sqrt(S));
    log_likelihood += std::log(std::exp(-0.5 * nu * nu / S) / std::sqrt(2.0 * M_PI * S));
  }
  const auto s = monitor.summary();
  EXPECT_EQ(s.count, 20000U);
  EXPECT_NEAR(s.nis, 1.0, 2.0 * s.nis_bound95);
  EXPECT_NEAR(s.mean, 0.0, 3.0 / std::sqrt(20000.0));
  EXPECT_LT(std::abs(s.lag1), 2.0 * s.white_bound95);
  EXPECT_GT(s.ljung_box_p, 0.001);
  EXPECT_NEAR(s.log_likelihood, log_likelihood, 1e-6);
  // The statistics of the regression's residual tests, about the mean; ours are about zero.
  EXPECT_NEAR(s.lag1, numerics::autocorrelation(e, 1).value[1], 1e-3);
}

TEST(InnovationMonitor, NoticesNoiseAssumedTooSmallAndColour) {
  numerics::RandomStream random(2, "coloured");
  InnovationMonitor monitor;
  double x = 0.0;
  for (int i = 0; i < 5000; ++i) {
    x = 0.6 * x + random.normal();  // variance 1 / (1 - 0.36), autocorrelation 0.6
    monitor.judge(0.01 * i, x, 1.0);
  }
  const auto s = monitor.summary();
  EXPECT_NEAR(s.nis, 1.0 / 0.64, 0.12);
  EXPECT_NEAR(s.lag1, 0.6, 0.04);
  EXPECT_LT(s.ljung_box_p, 1e-6);
}

TEST(InnovationMonitor, RefusesSpikesAndWhatIsNotANumber) {
  InnovationMonitor monitor(InnovationGate{.threshold = 3.0});
  EXPECT_TRUE(monitor.judge(0.0, 2.9, 1.0).accept);
  EXPECT_FALSE(monitor.judge(0.1, 3.1, 1.0).accept);
  EXPECT_TRUE(monitor.judge(0.2, -1.0, 1.0).accept);
  EXPECT_FALSE(monitor.judge(0.3, std::numeric_limits<double>::quiet_NaN(), 1.0).accept);
  EXPECT_FALSE(monitor.judge(0.4, std::numeric_limits<double>::infinity(), 1.0).accept);
  const auto s = monitor.summary();
  EXPECT_EQ(s.count, 5U);
  EXPECT_EQ(s.rejected, 3U);
  EXPECT_NEAR(s.nis, (2.9 * 2.9 + 1.0) / 2.0, 1e-12);
}

TEST(InnovationMonitor, TakesASensorBackThatWasRefusedForLong) {
  InnovationMonitor monitor(InnovationGate{.threshold = 5.0, .recovery_s = 1.0, .recovery_samples = 3});
  int refused = 0;
  double t = 0.0;
  InnovationMonitor::Verdict verdict;
  for (; t < 3.0; t += 0.125) {
    verdict = monitor.judge(t, 20.0, 1.0);
    if (verdict.accept) break;
    ++refused;
  }
  EXPECT_EQ(refused, 8);
  EXPECT_EQ(t, 1.0);
  EXPECT_NEAR(20.0 / std::sqrt(1.0 + verdict.extra_variance), 5.0, 1e-12);
  EXPECT_TRUE(monitor.judge(1.1, 15.0, 1.0).accept) << "stays back while it walks towards the filter";
  EXPECT_TRUE(monitor.judge(1.2, 1.0, 1.0).accept);
  EXPECT_FALSE(monitor.judge(1.3, 20.0, 1.0).accept) << "the rule starts again after a sound sample";
  EXPECT_EQ(monitor.summary().recovered, 2U);
}

/// Judges one sample every 0.1 s from `from` for `duration_s`, of which `share_outside` are beyond the gate.
void feed(InnovationMonitor& monitor, double from, double duration_s, double share_outside) {
  double due = 0.0;
  for (int i = 0; i < static_cast<int>(10.0 * duration_s); ++i) {
    due += share_outside;
    const bool outside = due >= 1.0;
    if (outside) due -= 1.0;
    static_cast<void>(monitor.judge(from + 0.1 * i, outside ? 1000.0 : 0.5, 1.0));
  }
}

TEST(InnovationMonitor, IsLostWhenItRefusesForLong) {
  InnovationMonitor monitor;
  feed(monitor, 0.0, 20.0, 0.0);
  feed(monitor, 20.0, 9.5, 1.0);
  EXPECT_FALSE(monitor.lost());
  feed(monitor, 29.5, 1.0, 1.0);
  EXPECT_TRUE(monitor.lost());
  EXPECT_NEAR(monitor.unsupported_since(), 19.9, 1e-9);
  EXPECT_NEAR(monitor.summary().unsupported_s, 10.5, 1e-9);
  EXPECT_DOUBLE_EQ(monitor.largest_innovation(), 1000.0);
  EXPECT_DOUBLE_EQ(monitor.largest_sigma(), 1.0);
  EXPECT_NEAR(monitor.largest_rate(), 1000.0 / 2.1, 1.0);
  monitor.restart();
  EXPECT_FALSE(monitor.lost());
}

// An innovation that crosses zero now and then is as lost; one that is mostly inside the gate is not.
TEST(InnovationMonitor, IsLostWhenMostOfItIsRefused) {
  InnovationMonitor mostly, less;
  feed(mostly, 0.0, 60.0, 0.7);
  feed(less, 0.0, 600.0, 0.45);
  EXPECT_TRUE(mostly.lost());
  EXPECT_FALSE(less.lost());
  EXPECT_LT(less.summary().unsupported_s, 1.0);
}

TEST(InnovationMonitor, IsNotLostBySilenceNorByAShortFault) {
  InnovationMonitor silent;
  feed(silent, 0.0, 1.0, 1.0);
  feed(silent, 100.0, 1.0, 1.0);  // a silence of 99 s stands for one
  EXPECT_FALSE(silent.lost());
  InnovationMonitor fault;
  for (int i = 0; i < 20; ++i) {
    feed(fault, 20.0 * i, 5.0, 1.0);
    feed(fault, 20.0 * i + 5.0, 15.0, 0.0);
  }
  EXPECT_FALSE(fault.lost());
  EXPECT_LT(fault.summary().unsupported_s, 5.2);
}

}  // namespace
}  // namespace veridyn::estimation
