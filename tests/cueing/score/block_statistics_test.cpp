#include "veridyn/cueing/score/block_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace veridyn::cueing {
namespace {

/// Smoothed noise, and the same `lag` samples later, `gain` times as strong, with noise.
struct Signals {
  std::vector<double> x, y;
};
Signals signals(std::size_t n, std::size_t lag, double gain, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> smooth(n + lag);
  double state = 0.0;
  for (double& v : smooth) v = state = 0.95 * state + normal(random);
  Signals s;
  for (std::size_t k = 0; k < n; ++k) {
    s.x.push_back(smooth[k + lag]);
    s.y.push_back(gain * smooth[k] + noise * normal(random));
  }
  return s;
}

TEST(BlockStatistics, AreThoseOfTheWholeSignals) {
  const Signals s = signals(5000, 0, 0.5, 1.0, 1);
  const BlockStatistics blocks(s.x, s.y, 0.02, 1.0);
  EXPECT_EQ(blocks.blocks(), 10u);
  double square = 0.0, above = 0.0, mx = 0.0, my = 0.0;
  for (std::size_t k = 0; k < s.x.size(); ++k) {
    square += std::pow(s.y[k] - s.x[k], 2);
    above += std::abs(s.y[k] - s.x[k]) > 1.0 ? 1.0 : 0.0;
    mx += s.x[k] / 5000.0;
    my += s.y[k] / 5000.0;
  }
  double xx = 0.0, yy = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < s.x.size(); ++k) {
    xx += (s.x[k] - mx) * (s.x[k] - mx);
    yy += (s.y[k] - my) * (s.y[k] - my);
    xy += (s.x[k] - mx) * (s.y[k] - my);
  }
  const BlockStatistics::Figures f = blocks.figures();
  EXPECT_NEAR(f.rmse, std::sqrt(square / 5000.0), 1e-12);
  EXPECT_NEAR(f.above, above / 5000.0, 1e-15);
  EXPECT_NEAR(f.pearson, xy / std::sqrt(xx * yy), 1e-10);
}

TEST(BlockStatistics, FindTheLag) {
  for (const std::size_t lag : {0U, 13U, 40U}) {
    const Signals s = signals(10000, lag, 0.7, 0.2, 2);
    const BlockStatistics::Figures f = BlockStatistics(s.x, s.y, 0.02, 1.0).figures();
    EXPECT_NEAR(f.lag, 0.02 * static_cast<double>(lag), 0.005);
    EXPECT_GT(f.at_lag, 0.95);
  }
}

TEST(BlockStatistics, OfASignalThatDoesNotMoveThereIsNoCorrelation) {
  const Signals s = signals(2000, 0, 1.0, 0.0, 3);
  const BlockStatistics::Figures f = BlockStatistics(s.x, std::vector<double>(2000, 0.3), 0.02, 1.0).figures();
  EXPECT_TRUE(std::isnan(f.pearson));
  EXPECT_TRUE(std::isnan(f.lag));
}

TEST(Bootstrapped, IntervalsHoldTheTruthAboutNinetyFiveTimesInAHundred) {
  // Of x and y = x/2 + noise: with unit innovations the variance of x is 1/(1 - 0.95^2).
  const double variance = 1.0 / (1.0 - 0.95 * 0.95);
  const double truth = 0.5 * std::sqrt(variance) / std::sqrt(0.25 * variance + 1.0);
  int held = 0;
  constexpr int kTrials = 200;
  for (int k = 0; k < kTrials; ++k) {
    const Signals s = signals(20000, 0, 0.5, 1.0, static_cast<unsigned>(100 + k));
    const BlockStatistics blocks(s.x, s.y, 0.02, 1.0);
    const Measured m = bootstrapped(blocks.blocks(), 1, 1, [&](std::span<const double> w, std::span<double> out) {
      out[0] = blocks.figures(w).pearson;
    })[0];
    held += m.low <= truth && truth <= m.high ? 1 : 0;
  }
  EXPECT_GE(held, 178);  // 40 blocks: 89 % and more
  EXPECT_LE(held, 199);
}

TEST(BlockStatistics, OfNoSignalsHaveNoFigures) {
  const BlockStatistics::Figures f = BlockStatistics().figures();
  for (const double figure : {f.rmse, f.pearson, f.lag, f.at_lag, f.above}) EXPECT_TRUE(std::isnan(figure));
}

TEST(Bootstrapped, SaysNoIntervalOfAFewBlocks) {
  const Signals s = signals(1000, 0, 0.5, 1.0, 1);
  const BlockStatistics blocks(s.x, s.y, 0.02, 1.0);
  const Measured m = bootstrapped(blocks.blocks(), 1, 1, [&](std::span<const double> w, std::span<double> out) {
    out[0] = blocks.figures(w).rmse;
  })[0];
  EXPECT_GT(m.value, 0.0);
  EXPECT_TRUE(std::isnan(m.low));
}

}  // namespace
}  // namespace veridyn::cueing
