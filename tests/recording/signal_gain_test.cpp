#include "veridyn/recording/signal_gain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::recording {
namespace {

const numerics::UniformGrid kGainGrid{0.0, 0.02, 3000};
const std::vector<TimeSpan> kGainSpan{{0.0, 60.0}};
constexpr double kGainBand_Hz = 1.0;

/// Three tones below the band.
double three_tones(double t) { return std::sin(1.1 * t) + 0.6 * std::sin(2.3 * t + 1.0) + 0.4 * std::sin(3.9 * t); }

std::vector<double> on_gain_grid(const std::function<double(double)>& value, double noise = 0.0,
                                 std::uint64_t seed = 1) {
  numerics::RandomStream random(seed, "gain");
  std::vector<double> out;
  for (std::size_t k = 0; k < kGainGrid.count; ++k) out.push_back(value(kGainGrid.at(k)) + noise * random.normal());
  return out;
}

TEST(SignalGain, IsExactForExactSignals) {
  const auto truth = on_gain_grid(three_tones);
  const auto reading = on_gain_grid([](double t) { return 1.2 * three_tones(t) + 0.5; });
  const auto gain = signal_gain({.reading = reading, .truth = truth}, kGainGrid, kGainSpan, kGainBand_Hz);
  ASSERT_TRUE(gain);
  EXPECT_NEAR(gain->low, 1.2, 1e-6);
  EXPECT_NEAR(gain->high, 1.2, 1e-6);
  EXPECT_NEAR(gain->correlation, 1.0, 1e-6);
}

// Noise in the truth pulls plain least squares down by the noise's share of its power, here to below 0.8.
TEST(SignalGain, BracketsTheGainWhicheverOfTheTwoIsNoisy) {
  for (const bool noisy_truth : {false, true}) {
    int inside = 0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      const auto truth = on_gain_grid(three_tones, noisy_truth ? 2.5 : 0.0, seed);
      const auto reading =
          on_gain_grid([](double t) { return 0.9 * three_tones(t); }, noisy_truth ? 0.0 : 2.0, seed + 1000);
      const auto gain = signal_gain({.reading = reading, .truth = truth}, kGainGrid, kGainSpan, kGainBand_Hz);
      ASSERT_TRUE(gain);
      EXPECT_TRUE(!noisy_truth || gain->low < 0.85);
      inside += gain->low - 3.0 * gain->low_sigma <= 0.9 && gain->high + 3.0 * gain->high_sigma >= 0.9 ? 1 : 0;
    }
    EXPECT_GE(inside, 99) << noisy_truth;
  }
}

TEST(SignalGain, TakesOffWhatOtherSignalsExplain) {
  const auto other = on_gain_grid([](double t) { return std::cos(1.7 * t); });
  const auto truth = on_gain_grid([](double t) { return three_tones(t) + 0.5 * std::cos(1.7 * t); });
  const auto reading = on_gain_grid([](double t) { return three_tones(t) - 2.0 * std::cos(1.7 * t); });
  const auto gain =
      signal_gain({.reading = reading, .truth = truth, .others = {other}}, kGainGrid, kGainSpan, kGainBand_Hz);
  ASSERT_TRUE(gain);
  EXPECT_NEAR(gain->low, 1.0, 1e-6);
}

TEST(SignalGain, OfUnrelatedSignalsIsAnything) {
  const auto truth = on_gain_grid(three_tones);
  const auto reading = on_gain_grid([](double t) { return std::sin(2.9 * t); });
  const auto gain = signal_gain({.reading = reading, .truth = truth}, kGainGrid, kGainSpan, kGainBand_Hz);
  ASSERT_TRUE(gain);
  EXPECT_LT(std::abs(gain->correlation), 0.3);
  EXPECT_GT(gain->high - gain->low, 1.0);
}

TEST(SignalGain, SaysNothingWhereThereIsNothing) {
  const auto truth = on_gain_grid(three_tones);
  const std::vector<double> missing(truth.size(), kNaN), constant(truth.size(), 2.0);
  EXPECT_FALSE(signal_gain({.reading = missing, .truth = truth}, kGainGrid, kGainSpan, kGainBand_Hz));
  EXPECT_FALSE(signal_gain({.reading = constant, .truth = truth}, kGainGrid, kGainSpan, kGainBand_Hz));
  EXPECT_FALSE(
      signal_gain({.reading = truth, .truth = truth}, kGainGrid, std::vector<TimeSpan>{{0.0, 5.0}}, kGainBand_Hz));
}

// A zero that is known makes a steady value tell the scale.
TEST(SignalGain, OfASteadyValueNeedsAKnownZero) {
  const auto truth = on_gain_grid([](double) { return 20.0; }, 0.05);
  const auto reading = on_gain_grid([](double) { return 22.0; }, 0.05, 2);
  const auto gain =
      signal_gain({.reading = reading, .truth = truth, .with_bias = false}, kGainGrid, kGainSpan, kGainBand_Hz);
  ASSERT_TRUE(gain);
  EXPECT_NEAR(gain->low, 1.1, 1e-3);
  EXPECT_NEAR(gain->high, 1.1, 1e-3);
}

}  // namespace
}  // namespace veridyn::recording
