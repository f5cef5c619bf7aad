#include "veridyn/vehicle/road/iso8608_road.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "tests/support/refusal.hpp"
#include "tests/vehicle/road/roads.hpp"

namespace veridyn::vehicle {
namespace {

using testing::at;
using ::testing::HasSubstr;

/// One-sided spectra by Welch's method: Hann windows of `window` samples, half overlapped, without reference to how the
/// road was made.
struct Welch {
  std::vector<double> wave_number, left, right;
  std::vector<std::complex<double>> cross;

  Welch(const Road& road, double from, double length, double step, std::size_t window) {
    Eigen::FFT<double> fft;
    std::vector<double> shape(window);
    double power = 0.0;
    for (std::size_t i = 0; i < window; ++i) {
      shape[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(window));
      power += shape[i] * shape[i];
    }
    const std::size_t bins = window / 2;
    left.assign(bins, 0.0);
    right.assign(bins, 0.0);
    cross.assign(bins, 0.0);
    double segments = 0.0;
    const double extent = step * static_cast<double>(window);
    for (double start = from; start + extent <= from + length; start += 0.5 * extent) {
      std::vector<double> a(window), b(window);
      for (std::size_t i = 0; i < window; ++i) {
        const double x = start + step * static_cast<double>(i);
        a[i] = shape[i] * road.height(at(x, 0.75));
        b[i] = shape[i] * road.height(at(x, -0.75));
      }
      std::vector<std::complex<double>> A, B;
      fft.fwd(A, a);
      fft.fwd(B, b);
      for (std::size_t k = 0; k < bins; ++k) {
        left[k] += std::norm(A[k]) * 2.0 * step / power;
        right[k] += std::norm(B[k]) * 2.0 * step / power;
        cross[k] += std::conj(A[k]) * B[k] * 2.0 * step / power;
      }
      segments += 1.0;
    }
    for (std::size_t k = 0; k < bins; ++k) {
      wave_number.push_back(static_cast<double>(k) / extent);
      left[k] /= segments;
      right[k] /= segments;
      cross[k] /= segments;
    }
  }

  template <typename Value, typename Result = typename Value::value_type>
  Result mean(const Value& values, double low, double high) const {
    Result sum{};
    double count = 0.0;
    for (std::size_t k = 0; k < wave_number.size(); ++k) {
      if (wave_number[k] < low || wave_number[k] >= high) continue;
      sum += values[k];
      count += 1.0;
    }
    return sum / count;
  }
};

TEST(Iso8608Road, HasTheRoughnessOfItsClass) {
  EXPECT_DOUBLE_EQ(iso8608_roughness('A'), 16e-6);
  EXPECT_DOUBLE_EQ(iso8608_roughness('D'), 1024e-6);
  EXPECT_DOUBLE_EQ(iso8608_roughness('H'), 262144e-6);
  EXPECT_THAT(why([] { (void)iso8608_roughness('I'); }), HasSubstr("'I' is not one of A"));
}

TEST(Iso8608Road, HasTheDensityOfTheStandardByAnEstimateOfItsOwn) {
  for (const double waviness : {2.0, 2.5}) {
    Iso8608Options options;
    options.roughness = iso8608_roughness('B');
    options.waviness = waviness;
    options.length = 5000.0;
    options.seed = 42;
    const Iso8608Road road(options);
    const Welch welch(road, 20.0, road.period(), 0.0437, 4096);
    for (double low = 0.04; low < 2.0; low *= std::sqrt(2.0)) {
      const double high = low * std::sqrt(2.0);
      // Mean of G0 (n/n0)^-w over the band.
      const double p = 1.0 - waviness;
      const double expected =
          64e-6 * std::pow(0.1, waviness) * (std::pow(high, p) - std::pow(low, p)) / p / (high - low);
      // Some 60 windows of 179 m, at least three lines a band: 180 values of two degrees of freedom, 7 %, less where
      // the waves are so many that they average; window and band edges some per cent at the steep low end.
      EXPECT_NEAR(welch.mean(welch.left, low, high) / expected, 1.0, 0.12) << low;
      EXPECT_NEAR(welch.mean(welch.right, low, high) / expected, 1.0, 0.12) << low;
    }
    EXPECT_LT(welch.mean(welch.left, 3.2, 8.0), 1e-4 * 64e-6 * std::pow(30.0, -waviness)) << "nothing above the band";
  }
}

TEST(Iso8608Road, HasTheVarianceOfItsBand) {
  Iso8608Options options;
  options.fade_in = 0.0;
  const Iso8608Road road(options);
  double sum = 0.0, squares = 0.0;
  const std::size_t count = 100000;
  const double period = road.period();
  for (std::size_t i = 0; i < count; ++i) {
    const double z = road.height(at(period * (1.0 + static_cast<double>(i) / static_cast<double>(count))));
    sum += z;
    squares += z * z;
  }
  // The integral of the density: G0 n0^2 (1/low - 1/high); interpolation reduces it by 1e-5.
  const double variance = 256e-6 * 0.01 * (1.0 / 0.011 - 1.0 / 2.83);
  EXPECT_NEAR(sum / static_cast<double>(count), 0.0, 1e-9);
  EXPECT_NEAR(squares / static_cast<double>(count) / variance, 1.0, 1e-4);
}

TEST(Iso8608Road, HasTheCoherenceItStates) {
  Iso8608Options options;
  options.length = 5000.0;
  const Iso8608Road road(options);
  const Welch welch(road, 20.0, road.period(), 0.0437, 4096);
  for (const auto& [low, high] : {std::pair{0.03, 0.06}, {0.08, 0.12}, {0.15, 0.25}, {0.3, 0.5}, {0.8, 2.0}}) {
    const double n = std::sqrt(low * high);
    const std::complex<double> cross = welch.mean(welch.cross, low, high);
    const double power = std::sqrt(welch.mean(welch.left, low, high) * welch.mean(welch.right, low, high));
    EXPECT_NEAR(cross.real() / power, std::exp(-4.0 * n), 0.07) << n;
    EXPECT_NEAR(cross.imag() / power, 0.0, 0.09) << n;
  }
  options.coherence_length = 0.0;
  const Iso8608Road equal(options);
  EXPECT_EQ(equal.height(at(123.4, 0.7)), equal.height(at(123.4, -0.7)));
}

TEST(Iso8608Road, ComesFromItsSeedAndGrowsFromALevelRoad) {
  Iso8608Options options;
  const Iso8608Road one(options), same(options);
  options.seed = 2;
  const Iso8608Road other(options);
  EXPECT_EQ(one.height(at(321.0)), same.height(at(321.0)));
  EXPECT_NE(one.height(at(321.0)), other.height(at(321.0)));
  EXPECT_EQ(one.height(at(0.0)), 0.0);
  EXPECT_EQ(one.height(at(-3.0)), 0.0);
  EXPECT_LT(std::abs(one.height(at(0.1))), 1e-4);
  const double p = one.period();
  EXPECT_NEAR(one.height(at(77.0)), one.height(at(77.0 + p)), 1e-12);
  EXPECT_NEAR(0.5 * (one.height(at(50.0, 1.0)) + one.height(at(50.0, -1.0))), one.height(at(50.0, 0.0)), 1e-16);
}

TEST(Iso8608Road, RefusesWhatIsNoRoad) {
  const auto refuse = [](auto change) {
    Iso8608Options options;
    change(options);
    return why([&] { (void)Iso8608Road(options); });
  };
  EXPECT_THAT(refuse([](auto& o) { o.roughness = std::nan(""); }), HasSubstr("roughness = nan must be"));
  EXPECT_THAT(refuse([](auto& o) { o.length = 1e9; }), HasSubstr("length"));
  EXPECT_THAT(refuse([](auto& o) { o.high = 0.001; }), HasSubstr("high"));
  EXPECT_THAT(refuse([](auto& o) { o.coherence_length = -1.0; }), HasSubstr("coherence_length"));
  EXPECT_THAT(refuse([](auto& o) { o.length = 50.0; }), HasSubstr("longest wave"));
}

}  // namespace
}  // namespace veridyn::vehicle
