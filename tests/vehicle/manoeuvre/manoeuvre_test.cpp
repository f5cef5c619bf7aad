#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <unsupported/Eigen/FFT>

#include "tests/vehicle/interrupting_progress.hpp"
#include "tests/vehicle/manoeuvre/steer_at.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle {
namespace {

using testing::steer;

TEST(Manoeuvre, TheReferenceIsTheTrapezoidOfTheSource) {
  const Manoeuvre m = reference_manoeuvre();
  const std::pair<double, double> expected[] = {{0.0, 0.0},  {2.0, 0.0},  {2.5, 2.5},  {3.0, 5.0},
                                                {15.0, 5.0}, {15.5, 2.5}, {16.0, 0.0}, {20.0, 0.0}};
  for (const auto& [time, angle] : expected) EXPECT_NEAR(steer(m, time), angle * kDegree, 1e-15) << time;
  EXPECT_EQ(m.default_duration, 20.0);
}

// FMVSS 126: 0.7 Hz, the second peak held for 500 ms, complete 1/0.7 + 0.5 s after its beginning.
TEST(Manoeuvre, SineWithDwellHoldsItsSecondPeak) {
  const Manoeuvre m = sine_with_dwell(0.05, 2.0);
  const double quarter = 0.25 / 0.7;
  EXPECT_NEAR(steer(m, 2.0), 0.0, 1e-15);
  EXPECT_NEAR(steer(m, 2.0 + quarter), 0.05, 1e-15);
  EXPECT_NEAR(steer(m, 2.0 + 3.0 * quarter), -0.05, 1e-15);
  EXPECT_NEAR(steer(m, 2.0 + 3.0 * quarter + 0.25), -0.05, 1e-15);
  EXPECT_NEAR(steer(m, 2.0 + 3.0 * quarter + 0.5), -0.05, 1e-15);
  EXPECT_NEAR(steer(m, 2.0 + 3.5 * quarter + 0.5), -0.05 * std::sin(kPi / 4.0), 1e-12);
  EXPECT_NEAR(steer(m, 2.0 + 4.0 * quarter + 0.5), 0.0, 1e-12);
  EXPECT_EQ(steer(m, 6.0), 0.0);
}

// Between two upward zero crossings of an exponential sweep the frequency grows by the same factor a second.
TEST(Manoeuvre, SweepsThroughItsFrequencies) {
  const Manoeuvre m = sweep_steer(0.02, 0.2, 3.2, 40.0, 1.0);
  std::vector<double> crossings;
  for (double t = 1.0; t < 40.5; t += 1e-3) {
    if (steer(m, t) <= 0.0 && steer(m, t + 1e-3) > 0.0) crossings.push_back(t);
  }
  for (std::size_t i = 1; i < crossings.size(); ++i) {
    const double middle = 0.5 * (crossings[i] + crossings[i - 1]) - 1.0;
    const double expected = 0.2 * std::pow(16.0, middle / 40.0);
    // The mean over one period differs from the value at its middle by a relative (growth * period)^2/24.
    EXPECT_NEAR(1.0 / (crossings[i] - crossings[i - 1]), expected, 0.03 * expected);
  }
}

TEST(Manoeuvre, RandomSteerIsBandLimitedAndReproducible) {
  const Manoeuvre m = random_steer(0.03, 0.2, 2.0, 60.0, 5), same = random_steer(0.03, 0.2, 2.0, 60.0, 5),
                  other = random_steer(0.03, 0.2, 2.0, 60.0, 6);
  std::vector<double> x;
  double peak = 0.0, difference = 0.0;
  for (double t = 1.0; t < 61.0; t += 0.01) {
    x.push_back(steer(m, t));
    peak = std::max(peak, std::abs(x.back()));
    EXPECT_EQ(x.back(), steer(same, t));
    difference = std::max(difference, std::abs(x.back() - steer(other, t)));
  }
  EXPECT_NEAR(peak, 0.03, 1e-3);
  EXPECT_GT(difference, 0.01);
  // By a Hann window over all of it, without its mean.
  const auto n = static_cast<double>(x.size());
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] = (x[k] - mean) * (1.0 - std::cos(2.0 * kPi * static_cast<double>(k) / n));
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, x);
  double within = 0.0, beyond = 0.0;
  for (std::size_t k = 0; k <= x.size() / 2; ++k) {
    const double frequency_Hz = 100.0 * static_cast<double>(k) / n;
    (frequency_Hz >= 0.15 && frequency_Hz <= 2.1 ? within : beyond) += std::norm(spectrum[k]);
  }
  EXPECT_LT(beyond, 1e-3 * within);
}

TEST(Manoeuvre, PreparingARandomSteerStopsWhenInterrupted) {
  testing::InterruptingProgress progress(1000);
  const Manoeuvre m = random_steer(0.03, 0.2, 2.0, 60.0, 5, 1.0, progress);
  // 100 samples a second, of which 999 were made.
  EXPECT_NE(steer(m, 1.0 + 9.9), 0.0);
  EXPECT_EQ(steer(m, 1.0 + 10.0), 0.0);
  EXPECT_EQ(m.default_duration, 63.0);
}

TEST(Manoeuvre, RampSteerGrowsAtItsRateAndHolds) {
  const Manoeuvre m = ramp_steer(0.1, 0.02, 1.0, 3.0);
  EXPECT_EQ(m.kind, ManoeuvreKind::kRampSteer);
  EXPECT_EQ(steer(m, 1.0), 0.0);
  EXPECT_NEAR(steer(m, 3.5), 0.05, 1e-15);
  EXPECT_NEAR(steer(m, 6.0), 0.1, 1e-15);
  EXPECT_EQ(steer(m, 8.9), 0.1);
  EXPECT_NEAR(m.default_duration, 1.0 + 5.0 + 3.0, 1e-12);
  EXPECT_NEAR(steer(ramp_steer(-0.1, 0.02), 3.5), -0.05, 1e-15);
}

TEST(Manoeuvre, FishhookTurnsIn720DegreesASecondOfTheHandWheel) {
  const Manoeuvre m = fishhook(0.15, 0.75, 1.0, 0.25);
  EXPECT_NEAR(steer(m, 1.1), 0.075, 1e-12);
  EXPECT_NEAR(steer(m, 1.2 + 0.25), 0.15, 1e-12);
  EXPECT_NEAR(steer(m, 1.45 + 0.4), -0.15, 1e-12);
  EXPECT_NEAR(steer(m, 1.85 + 3.0), -0.15, 1e-12);
  EXPECT_NEAR(steer(m, 1.85 + 5.0), 0.0, 1e-12);
}

}  // namespace
}  // namespace veridyn::vehicle
