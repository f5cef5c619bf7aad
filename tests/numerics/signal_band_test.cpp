#include "veridyn/numerics/signal_band.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::numerics {
namespace {

constexpr double kRate_Hz = 100.0;
constexpr std::size_t kSamples = 6000;

/// Ten tones between two frequencies, of rms 1.
std::vector<double> tones(double low_Hz, double high_Hz, double rate_Hz = kRate_Hz, std::size_t samples = kSamples) {
  constexpr int kTones = 10;
  RandomStream draw(7, "tones");
  std::vector<double> out(samples, 0.0);
  for (int i = 0; i < kTones; ++i) {
    const double frequency = low_Hz + (high_Hz - low_Hz) * i / (kTones - 1);
    const double phase = draw.uniform(0.0, 2.0 * kPi);
    for (std::size_t k = 0; k < samples; ++k)
      out[k] += std::sqrt(2.0 / kTones) * std::sin(2.0 * kPi * frequency * static_cast<double>(k) / rate_Hz + phase);
  }
  return out;
}

std::vector<double> with_noise(std::vector<double> signal, double sigma, std::uint64_t seed) {
  RandomStream draw(seed, "noise");
  for (double& v : signal) v += sigma * draw.normal();
  return signal;
}

/// Mean square of a difference, `margin` samples at both ends left out.
double mean_square(const std::vector<double>& of, const std::vector<double>& from, std::size_t margin) {
  double sum = 0.0;
  for (std::size_t k = margin; k + margin < of.size(); ++k) sum += (of[k] - from[k]) * (of[k] - from[k]);
  return sum / static_cast<double>(of.size() - 2 * margin);
}

/// Widest kernel is that of 0.5 to 0.75 Hz, 60 dB: half of 3.6/0.25 Hz (Kaiser's formula) is 7.3 s.
constexpr std::size_t kMargin = 750;

// The low-pass is linear: of two recordings with opposite noise it leaves the noise at opposite signs, and their mean
// is what it makes of the signal alone. 60 dB: 0.001 in the pass band, within Kaiser's empirical formula.
TEST(SignalBand, KeepsASignalToAThousandth) {
  for (const double top_Hz : {0.4, 0.8, 3.0}) {
    const std::vector<double> signal = tones(0.1, top_Hz);
    int compared = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const BandLimited one = band_limited(with_noise(signal, 0.1, seed), kRate_Hz, 1e-3);
      const BandLimited other = band_limited(with_noise(signal, -0.1, seed), kRate_Hz, 1e-3);
      ASSERT_GT(one.band_Hz, top_Hz);
      if (one.band_Hz != other.band_Hz) continue;  // by chance
      ++compared;
      std::vector<double> mean = one.value;
      for (std::size_t k = 0; k < mean.size(); ++k) mean[k] = 0.5 * (mean[k] + other.value[k]);
      EXPECT_LT(std::sqrt(mean_square(mean, signal, kMargin)), 1.1e-3) << top_Hz;
      EXPECT_GT(std::sqrt(mean_square(one.value, signal, kMargin)), 1e-2) << top_Hz;  // the noise in the band
    }
    EXPECT_GE(compared, 3) << top_Hz;
  }
}

// White noise of a tenth of the signal: the band is the signal's, and what is left of the noise is the share that is
// said. Of 20 recordings of 45 s with bands of 1 Hz or more there are 1800 independent values or more: 3.3 % (one
// standard error) of their mean square.
TEST(SignalBand, TakesOffTheNoiseOutsideTheBandAndSaysHowMuchIsLeft) {
  constexpr double kSigma = 0.1;
  const std::vector<double> signal = tones(0.1, 0.8);
  double left = 0.0, said = 0.0;
  constexpr int kRecordings = 20;
  for (std::uint64_t seed = 1; seed <= kRecordings; ++seed) {
    const BandLimited found = band_limited(with_noise(signal, kSigma, seed), kRate_Hz, 1e-3);
    // The narrowest of 0.5, 0.71, 1, 1.41, ... Hz that lets 0.8 Hz pass is 0.71 or 1 Hz, and the next one is taken.
    EXPECT_GE(found.band_Hz, 0.99) << seed;
    EXPECT_LE(found.band_Hz, 1.5) << seed;
    // An ideal low-pass at the middle of its transition leaves 2 (1.25 band)/rate.
    EXPECT_NEAR(found.noise_share, 2.5 * found.band_Hz / kRate_Hz, 0.1 * found.noise_share) << seed;
    left += mean_square(found.value, signal, kMargin) / (kSigma * kSigma) / kRecordings;
    said += found.noise_share / kRecordings;
  }
  EXPECT_NEAR(left / said, 1.0, 0.1);
}

TEST(SignalBand, TakesTheNarrowestBandOfNoiseAlone) {
  const BandLimited found = band_limited(with_noise(std::vector<double>(kSamples, 0.0), 1.0, 3), kRate_Hz, 1e-3);
  EXPECT_NEAR(found.band_Hz, 0.5 * std::sqrt(2.0), 1e-12);
}

TEST(SignalBand, LeavesASignalWithoutNoiseAsItIs) {
  const std::vector<double> signal = tones(0.1, 0.8);
  const BandLimited clean = band_limited(signal, kRate_Hz, 1e-2);
  EXPECT_EQ(clean.value, signal);
  EXPECT_EQ(clean.band_Hz, 0.0);
  EXPECT_EQ(clean.noise_share, 1.0);
  // The least noise decides: the same recording above and below it.
  const std::vector<double> noisy = with_noise(signal, 0.1, 1);
  EXPECT_EQ(band_limited(noisy, kRate_Hz, 0.12).value, noisy);
  EXPECT_GT(band_limited(noisy, kRate_Hz, 0.08).band_Hz, 0.0);
}

// 15 Hz need a band of 16 Hz, the widest, which has none next to it.
TEST(SignalBand, LeavesASignalThatFillsTheBandAsItIs) {
  const std::vector<double> noisy = with_noise(tones(13.0, 15.0), 0.1, 1);
  const BandLimited found = band_limited(noisy, kRate_Hz, 1e-3);
  EXPECT_EQ(found.value, noisy);
  EXPECT_EQ(found.band_Hz, 0.0);
}

// Below 3.54 Hz a fifth of the rate leaves less than two bands to choose from.
TEST(SignalBand, LeavesARecordingOfTooLowARateAsItIs) {
  for (const double rate_Hz : {1.0, 3.5}) {
    const std::vector<double> noisy = with_noise(tones(0.02, 0.1, rate_Hz), 0.3, 1);
    EXPECT_EQ(band_limited(noisy, rate_Hz, 1e-3).value, noisy) << rate_Hz;
  }
  const std::vector<double> faster = with_noise(tones(0.02, 0.1, 3.6), 0.3, 1);
  EXPECT_GT(band_limited(faster, 3.6, 1e-3).band_Hz, 0.0);
}

// A gap stays one, stretches too short for the kernel stay as they are, and the long ones are smoothed on their own.
TEST(SignalBand, SmoothsTheStretchesBetweenGaps) {
  const std::vector<double> signal = tones(0.1, 0.8);
  std::vector<double> noisy = with_noise(signal, 0.1, 5);
  constexpr std::size_t kGap = 3000, kShort = 20, kNext = kGap + 1 + kShort;
  noisy[kGap] = noisy[kNext] = kNaN;
  const BandLimited found = band_limited(noisy, kRate_Hz, 1e-3);
  ASSERT_GT(found.band_Hz, 0.0);
  ASSERT_EQ(found.value.size(), noisy.size());
  for (std::size_t k = 0; k < noisy.size(); ++k) EXPECT_EQ(std::isfinite(found.value[k]), k != kGap && k != kNext) << k;
  for (std::size_t k = kGap + 1; k < kNext; ++k) EXPECT_EQ(found.value[k], noisy[k]);
  const std::vector<double> before(found.value.begin(), found.value.begin() + kGap);
  const std::vector<double> truth(signal.begin(), signal.begin() + kGap);
  EXPECT_LT(std::sqrt(mean_square(before, truth, kMargin)), 0.03);  // 0.1 sqrt(share) = 0.02
  // Nothing of what lies beyond the gap is in it.
  std::vector<double> other = noisy;
  for (std::size_t k = kNext + 1; k < other.size(); ++k) other[k] = -noisy[k];
  const BandLimited mirrored = band_limited(other, kRate_Hz, 1e-3);
  ASSERT_EQ(mirrored.band_Hz, found.band_Hz);
  for (std::size_t k = 0; k < kGap; ++k) EXPECT_EQ(mirrored.value[k], found.value[k]) << k;
}

TEST(SignalBand, TakesNothingOffRecordingsWithoutAnyStretch) {
  EXPECT_TRUE(band_limited({}, kRate_Hz, 0.0).value.empty());
  const BandLimited none = band_limited(std::vector<double>(500, kNaN), kRate_Hz, 0.0);
  EXPECT_EQ(none.band_Hz, 0.0);
  const std::vector<double> few = with_noise(tones(0.1, 0.8, kRate_Hz, 8), 0.1, 1);
  EXPECT_EQ(band_limited(few, kRate_Hz, 1e-3).value, few);
}

/// A first-order process of variance one and the corner frequency `corner` [rad/s].
std::vector<double> first_order_process(double corner, std::uint64_t seed) {
  RandomStream draw(seed, "process");
  const double keeps = std::exp(-corner / kRate_Hz);
  std::vector<double> out{draw.normal()};
  while (out.size() < kSamples) out.push_back(keeps * out.back() + std::sqrt(1.0 - keeps * keeps) * draw.normal());
  return out;
}

double mean_product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum / static_cast<double>(a.size());
}

// The error of the best filter without causality is the integral of S N/(S + N): of the spectrum 2 c/(c^2 + w^2) in
// white noise N that is 1/sqrt(1 + 2/(c N)). What is left does not go with the result, so that a gain that is fitted to
// it is right; a gain fitted to the noisy signal is too small by 1/(1 + noise).
TEST(Denoised, IsTheBestFilterOfAFirstOrderProcess) {
  constexpr double kCorner = 2.0 * kPi * 0.3, kSigma = 0.5;
  const double best = 1.0 / std::sqrt(1.0 + 2.0 / (kCorner * kSigma * kSigma / kRate_Hz));
  double left = 0.0, gain = 0.0, gain_of_noisy = 0.0;
  constexpr int kRecordings = 20;
  for (std::uint64_t seed = 1; seed <= kRecordings; ++seed) {
    const std::vector<double> signal = first_order_process(kCorner, seed);
    const std::vector<double> noisy = with_noise(signal, kSigma, seed);
    const BandLimited found = denoised(noisy, kRate_Hz, 1e-3);
    left += mean_square(found.value, signal, 0) / kRecordings;
    gain += mean_product(found.value, signal) / mean_product(found.value, found.value) / kRecordings;
    gain_of_noisy += mean_product(noisy, signal) / mean_product(noisy, noisy) / kRecordings;
  }
  EXPECT_NEAR(left / best, 1.0, 0.1);
  EXPECT_NEAR(gain, 1.0, 0.01);
  EXPECT_NEAR(gain_of_noisy, 1.0 / (1.0 + kSigma * kSigma), 0.02);
}

// What lies below a signal is taken off as well.
TEST(Denoised, LeavesLessThanTheBandHas) {
  const std::vector<double> signal = tones(0.7, 0.8);
  double by_band = 0.0, left = 0.0, said = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<double> noisy = with_noise(signal, 0.3, seed);
    const BandLimited best = denoised(noisy, kRate_Hz, 1e-3);
    by_band += mean_square(band_limited(noisy, kRate_Hz, 1e-3).value, signal, kMargin);
    left += mean_square(best.value, signal, kMargin);
    said += best.noise_share * best.noise;
  }
  EXPECT_LT(left, 0.8 * by_band);
  // Parzen's window widens the band of the signal by 0.2 Hz: a little more is said.
  EXPECT_GT(said / left, 0.9);
  EXPECT_LT(said / left, 1.3);
}

// They have fewer neighbours, on one side. An extension by a mirror would turn the slope: 0.3 at the last sample.
TEST(Denoised, KeepsTheEnds) {
  constexpr double kSigma = 0.02;
  const std::vector<double> signal = tones(0.1, 0.8);
  const std::vector<double> found = denoised(with_noise(signal, kSigma, 1), kRate_Hz, 1e-3).value;
  for (std::size_t k = 0; k < 50; ++k) {
    EXPECT_NEAR(found[k], signal[k], 5.0 * kSigma) << k;
    EXPECT_NEAR(found[kSamples - 1 - k], signal[kSamples - 1 - k], 5.0 * kSigma) << k;
  }
}

TEST(Denoised, KeepsTheMeanAndGoesAroundHoles) {
  std::vector<double> noisy = with_noise(tones(0.1, 0.8), 0.1, 1);
  for (double& v : noisy) v += 5.0;
  for (std::size_t k = 3000; k < 3010; ++k) noisy[k] = kNaN;
  for (std::size_t k = 3100; k < 3105; ++k) noisy[k] = kNaN;
  const BandLimited found = denoised(noisy, kRate_Hz, 1e-3);
  double before = 0.0, after = 0.0;
  for (std::size_t k = 0; k < noisy.size(); ++k) {
    ASSERT_EQ(std::isfinite(found.value[k]), std::isfinite(noisy[k])) << k;
    if (k < 3000) before += noisy[k] / 3000.0, after += found.value[k] / 3000.0;
  }
  EXPECT_NEAR(after, before, 0.01);
  // Shorter than 16 s: low-passed only.
  const std::vector<double> brief(noisy.begin(), noisy.begin() + 700);
  EXPECT_EQ(denoised(brief, kRate_Hz, 1e-3).value, band_limited(brief, kRate_Hz, 1e-3).value);
  const std::vector<double> clean = tones(0.1, 0.8);
  EXPECT_EQ(denoised(clean, kRate_Hz, 1e-2).value, clean);
}

}  // namespace
}  // namespace veridyn::numerics
