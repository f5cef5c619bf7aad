#include "veridyn/numerics/filters.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace {
using namespace veridyn::numerics;
using veridyn::kPi;

constexpr LowPassDesign kDesign{.rate_Hz = 100.0, .pass_Hz = 10.0, .stop_Hz = 15.0, .attenuation_dB = 60.0};

std::vector<double> white_noise(std::size_t count) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  std::vector<double> x(count);
  for (double& v : x) v = normal(generator);
  return x;
}

TEST(LowPass, KeepsItsPassBandFlatAndItsStopBandDown) {
  const FirKernel kernel = low_pass(kDesign);
  // 60 dB: 0.001; Kaiser's empirical formula keeps it within some per cent.
  for (double f = 0.0; f <= 10.0; f += 0.1) EXPECT_NEAR(kernel.gain(f), 1.0, 1.1e-3) << f;
  for (double f = 15.0; f <= 50.0; f += 0.1) EXPECT_NEAR(kernel.gain(f), 0.0, 1.1e-3) << f;
}

// The point of the pair: a derivative and what it is regressed on have gone through the same filter.
TEST(LowPassDifferentiator, HasTheGainOfTheLowPassTimesTheFrequency) {
  const FirKernel smoother = low_pass(kDesign), differentiator = low_pass_differentiator(kDesign);
  for (double f = 0.1; f <= 50.0; f += 0.1) {
    EXPECT_NEAR(differentiator.gain(f), 2.0 * kPi * f * smoother.gain(f), 1e-3 * 2.0 * kPi * 15.0) << f;
  }
  for (double f = 0.1; f <= 10.0; f += 0.1) {
    EXPECT_NEAR(differentiator.gain(f) / (2.0 * kPi * f), smoother.gain(f), 3e-4) << f;
  }
}

TEST(LowPassDifferentiator, DifferentiatesASineWithoutPhase) {
  std::vector<double> x(2000), expected(2000);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double t = 0.01 * static_cast<double>(k);
    x[k] = std::sin(2.0 * kPi * 3.0 * t);
    expected[k] = 2.0 * kPi * 3.0 * std::cos(2.0 * kPi * 3.0 * t);
  }
  const std::vector<double> y = filter(x, low_pass_differentiator(kDesign), Edges::kNan);
  const std::size_t m = low_pass_differentiator(kDesign).half_width();
  EXPECT_TRUE(std::isnan(y[m - 1]) && std::isnan(y[y.size() - m]));
  for (std::size_t k = m; k < y.size() - m; ++k) EXPECT_NEAR(y[k], expected[k], 1.4e-3 * 2.0 * kPi * 3.0);
}

TEST(Filter, NoiseGainIsTheVarianceOfFilteredWhiteNoise) {
  const std::vector<double> x = white_noise(400000);
  for (const FirKernel& kernel :
       {low_pass(kDesign), low_pass_differentiator(kDesign), SavitzkyGolay(3, 9, 1, 100.0).kernel()}) {
    const std::vector<double> y = filter(x, kernel, Edges::kNan);
    double power = 0.0, lagged = 0.0, count = 0.0;
    for (std::size_t k = 0; k + 3 < y.size(); ++k) {
      if (!std::isfinite(y[k]) || !std::isfinite(y[k + 3])) continue;
      power += y[k] * y[k];
      lagged += y[k] * y[k + 3];
      count += 1.0;
    }
    EXPECT_NEAR(power / count / kernel.noise_gain(), 1.0, 0.03);
    EXPECT_NEAR(lagged / count / kernel.noise_gain(), kernel.noise_autocovariance(3) / kernel.noise_gain(), 0.03);
  }
}

TEST(Filter, TreatsStretchesBetweenGapsSeparately) {
  const FirKernel kernel = low_pass(kDesign);
  std::vector<double> x = white_noise(600);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  x[300] = nan;
  for (std::size_t k = 320; k < 325; ++k) x[k] = nan;  // leaves a stretch of 19 samples, shorter than half a kernel
  const std::vector<double> y = filter(x, kernel);
  const std::vector<double> alone = filter(std::span<const double>(x).first(300), kernel);
  for (std::size_t k = 0; k < 300; ++k) EXPECT_EQ(y[k], alone[k]);
  for (std::size_t k = 300; k < 325; ++k) EXPECT_TRUE(std::isnan(y[k])) << k;
  for (std::size_t k = 325; k < 600; ++k) EXPECT_TRUE(std::isfinite(y[k])) << k;
}

TEST(Filter, KeepsAStraightLineUpToTheEdges) {
  std::vector<double> x(300);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = 2.0 - 0.3 * static_cast<double>(k);
  const std::vector<double> y = filter(x, low_pass(kDesign));
  const std::vector<double> slope = filter(x, low_pass_differentiator(kDesign));
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_NEAR(y[k], x[k], 1e-10);
    EXPECT_NEAR(slope[k], -30.0, 1e-9);
  }
}

TEST(LowPass, RefusesADesignThatCannotBe) {
  EXPECT_THROW((void)low_pass({.rate_Hz = 100.0, .pass_Hz = 40.0, .stop_Hz = 60.0}), veridyn::InputError);
  EXPECT_THROW((void)low_pass({.rate_Hz = 100.0, .pass_Hz = 20.0, .stop_Hz = 10.0}), veridyn::InputError);
}

// Savitzky & Golay's own table: smoothing by a quadratic over 5 points, (-3, 12, 17, 12, -3)/35; first derivative
// (-2..2)/10.
TEST(SavitzkyGolay, MatchesThePublishedCoefficients) {
  const std::vector<double> smoothing = SavitzkyGolay(2, 2).kernel().taps;
  const double expected[5] = {-3.0, 12.0, 17.0, 12.0, -3.0};
  const std::vector<double> derivative = SavitzkyGolay(2, 2, 1).kernel().taps;
  for (std::size_t j = 0; j < 5; ++j) {
    EXPECT_NEAR(smoothing[j], expected[j] / 35.0, 1e-14);
    EXPECT_NEAR(derivative[j], (static_cast<double>(j) - 2.0) / 10.0, 1e-14);
  }
}

TEST(SavitzkyGolay, IsExactForPolynomialsOfItsOrderAtTheEdgesToo) {
  std::vector<double> x(80), first(80), second(80);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double t = 0.02 * static_cast<double>(k);
    x[k] = 1.0 - 2.0 * t + 0.5 * t * t * t;
    first[k] = -2.0 + 1.5 * t * t;
    second[k] = 3.0 * t;
  }
  const std::vector<double> y0 = SavitzkyGolay(4, 7, 0, 50.0).apply(x), y1 = SavitzkyGolay(4, 7, 1, 50.0).apply(x),
                            y2 = SavitzkyGolay(4, 7, 2, 50.0).apply(x);
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_NEAR(y0[k], x[k], 1e-12);
    EXPECT_NEAR(y1[k], first[k], 1e-10);
    EXPECT_NEAR(y2[k], second[k], 1e-8);
  }
  EXPECT_THROW(SavitzkyGolay(5, 2), veridyn::InputError);
  EXPECT_THROW(SavitzkyGolay(2, 2, 3), veridyn::InputError);
}

}  // namespace
