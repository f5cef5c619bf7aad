#include "veridyn/numerics/delay.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace {
using namespace veridyn::numerics;

// A sum of random sines below 8 Hz: its delayed copy is known at any instant.
struct Sines {
  std::vector<double> frequency, phase;
  explicit Sines(unsigned seed) {
    std::mt19937_64 generator(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int i = 0; i < 60; ++i) {
      frequency.push_back(0.2 + 7.8 * uniform(generator));
      phase.push_back(2.0 * std::numbers::pi * uniform(generator));
    }
  }
  [[nodiscard]] double at(double t) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < frequency.size(); ++i)
      sum += std::sin(2.0 * std::numbers::pi * frequency[i] * t + phase[i]);
    return sum / std::sqrt(30.0);
  }
};

TEST(EstimateDelay, FindsAFractionOfASample) {
  const Sines s(1);
  for (const double delay : {0.0, 0.0137, -0.0262, 0.12345}) {
    std::vector<double> a, b;
    for (int k = 0; k < 4000; ++k) {
      a.push_back(s.at(0.01 * k));
      b.push_back(-0.7 * s.at(0.01 * k - delay) + 3.0);
    }
    const DelayEstimate e = estimate_delay(a, b, 100.0);
    EXPECT_TRUE(e.determined) << e.reason;
    EXPECT_NEAR(e.delay_s, delay, 1e-4);
    EXPECT_LT(e.correlation, -0.98);
  }
}

TEST(EstimateDelay, StandardErrorHoldsUnderNoise) {
  double squares = 0.0;
  const int runs = 60;
  for (int m = 0; m < runs; ++m) {
    const Sines s(static_cast<unsigned>(m + 10));
    std::mt19937_64 generator(static_cast<unsigned>(m));
    std::normal_distribution<double> normal(0.0, 0.5);
    std::vector<double> a, b;
    for (int k = 0; k < 2000; ++k) {
      a.push_back(s.at(0.01 * k));
      b.push_back(s.at(0.01 * k - 0.033) + normal(generator));
    }
    const DelayEstimate e = estimate_delay(a, b, 100.0);
    EXPECT_TRUE(e.determined);
    squares += std::pow((e.delay_s - 0.033) / e.sigma_s, 2) / runs;
  }
  EXPECT_GT(squares, 0.4);
  EXPECT_LT(squares, 2.0);
}

TEST(EstimateDelay, SaysWhenItIsNotDetermined) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  std::vector<double> a, b, sine, later;
  for (int k = 0; k < 4000; ++k) {
    a.push_back(normal(generator));
    b.push_back(normal(generator));
    sine.push_back(std::sin(2.0 * std::numbers::pi * 10.0 * 0.01 * k));
    later.push_back(std::sin(2.0 * std::numbers::pi * 10.0 * (0.01 * k - 0.02)));
  }
  EXPECT_FALSE(estimate_delay(a, b, 100.0).determined);
  const DelayEstimate periodic = estimate_delay(sine, later, 100.0);
  EXPECT_FALSE(periodic.determined);
  EXPECT_THAT(std::string(periodic.reason), testing::HasSubstr("another delay"));
  EXPECT_FALSE(estimate_delay(a, std::vector<double>(4000, 1.0), 100.0).determined);
}

// Near its peak the correlation of a slow signal falls by less than the weights of a short sinc differ from one.
TEST(EstimateDelay, OfASlowSignalIsExactBetweenSamples) {
  const auto slow = [](double t) { return std::sin(1.7 * t) + std::sin(2.9 * t + 1.0) + std::sin(0.8 * t + 2.0); };
  for (const double delay : {0.0, 0.0025, 0.005, 0.0071, -0.0034}) {
    std::vector<double> a, b;
    for (int k = 0; k < 6000; ++k) {
      a.push_back(slow(0.01 * k));
      b.push_back(slow(0.01 * k - delay));
    }
    EXPECT_NEAR(estimate_delay(a, b, 100.0).delay_s, delay, 5e-4) << delay;
  }
}

TEST(EstimateDelay, ToleratesGaps) {
  const Sines s(2);
  std::vector<double> a, b;
  for (int k = 0; k < 4000; ++k) {
    a.push_back(s.at(0.01 * k));
    b.push_back(k % 97 < 10 ? std::numeric_limits<double>::quiet_NaN() : s.at(0.01 * k - 0.05));
  }
  EXPECT_NEAR(estimate_delay(a, b, 100.0).delay_s, 0.05, 3e-4);
}

}  // namespace
