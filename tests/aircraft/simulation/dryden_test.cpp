#include "veridyn/aircraft/simulation/dryden.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cstdlib>

#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

// Frequency response of the filter's states gives the covariance by an independent way: the variance of the gust is the
// integral of |H|^2 over frequency for white noise of unit two-sided power spectral density.
double variance_from_spectrum(double L, double Va) {
  const double b = Va / L;
  double sum = 0.0;
  // w = b tan(x) maps the whole axis to (-pi/2, pi/2); the midpoint rule is spectrally accurate there.
  constexpr int kN = 2000;
  for (int i = 0; i < kN; ++i) {
    const double x = -M_PI / 2 + (i + 0.5) * M_PI / kN;
    const double w = b * std::tan(x), jacobian = b / (std::cos(x) * std::cos(x));
    const double H2 = 3 * b * (w * w + b * b / 3) / ((w * w + b * b) * (w * w + b * b));
    sum += H2 * jacobian * M_PI / kN / (2 * M_PI);
  }
  return sum;
}

TEST(Dryden, KeepsItsStationaryCovarianceForAnyStep) {
  Matrix2d P;
  P << 0.5, 0.25, 0.25, 0.25;
  for (const double theta : {1e-8, 1e-5, 2.5e-4, 0.01, 0.4, 0.499, 0.5, 0.501, 2.0, 50.0}) {
    const DrydenStep s(theta);
    Matrix2d F, G;
    F << s.decay, 0, s.coupling, s.decay;
    G << s.noise11, 0, s.noise21, s.noise22;
    // The discrete Lyapunov equation.
    EXPECT_LT((F * P * F.transpose() + G * G.transpose() - P).norm(), 1e-15) << theta;
  }
}

TEST(Dryden, HasTheVarianceOfItsSpectrum) {
  Matrix2d P;
  P << 0.5, 0.25, 0.25, 0.25;
  const Vector2d c(std::sqrt(3.0), std::sqrt(3.0) * (1 / std::sqrt(3.0) - 1));
  EXPECT_NEAR(c.dot(P * c), 1.0, 1e-15);
  EXPECT_NEAR(variance_from_spectrum(200, 20), 1.0, 1e-12);
}

TEST(Dryden, TwoHalfStepsAreOneStep) {
  for (const double theta : {1e-4, 0.3, 0.8}) {
    const auto matrices = [](double t) {
      const DrydenStep s(t);
      Matrix2d F, G;
      F << s.decay, 0, s.coupling, s.decay;
      G << s.noise11, 0, s.noise21, s.noise22;
      return std::pair(F, Matrix2d(G * G.transpose()));
    };
    const auto [F1, Q1] = matrices(theta);
    const auto [Fh, Qh] = matrices(theta / 2);
    EXPECT_LT((Fh * Fh - F1).norm(), 1e-15);
    EXPECT_LT((Fh * Qh * Fh.transpose() + Qh - Q1).norm(), 1e-14 * Q1.norm());
    // The smallest entry, of order theta^3, has to be right as well: it carries the smoothness of the gust.
    EXPECT_NEAR((Fh * Qh * Fh.transpose() + Qh)(1, 1) / Q1(1, 1), 1.0, 1e-12);
  }
}

TEST(Dryden, SampleMomentsAndCorrelationMatchTheTheory) {
  // At 20 m/s and L = 50 m the correlation time is 2.5 s; 20 independent flights of 4000 s have about 20 * 4000 / 2.5 /
  // 2 = 16000 independent samples, so a variance has a relative standard error of 1.1 %. Bound: 4 standard errors.
  const DrydenSettings settings{50, 50, 50, 1.0, 2.0, 1.4};
  double u2 = 0, v2 = 0, w2 = 0, u_lag = 0;
  long n = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    DrydenGusts gusts(settings, numerics::RandomStream(seed, "gust"));
    double previous = gusts.gust()[0];
    for (int i = 0; i < 16000; ++i) {
      gusts.advance(0.25, 20.0);
      const auto g = gusts.gust();
      u2 += g[0] * g[0];
      v2 += g[1] * g[1];
      w2 += g[2] * g[2];
      u_lag += previous * g[0];
      previous = g[0];
      ++n;
    }
  }
  const double count = static_cast<double>(n);
  EXPECT_NEAR(u2 / count, 1.0, 0.045);
  EXPECT_NEAR(v2 / count, 4.0, 4.0 * 0.045);
  EXPECT_NEAR(w2 / count, 1.96, 1.96 * 0.045);
  EXPECT_NEAR(u_lag / u2, std::exp(-0.25 * 20 / 50), 0.01);
}

/// Mean of Hann-windowed periodograms of the three gusts at `frequencies`: two-sided, so that its integral over
/// frequency/(2 pi) is the variance.
std::array<std::vector<double>, 3> periodogram(const DrydenSettings& settings, double step, double Va, int windows,
                                               const std::vector<double>& frequencies) {
  constexpr int kLength = 1024;
  std::array<std::vector<double>, 3> power;
  for (auto& p : power) p.assign(frequencies.size(), 0.0);
  DrydenGusts gusts(settings, numerics::RandomStream(5, "spectrum"));
  std::vector<double> hann(kLength);
  double energy = 0.0;
  for (int i = 0; i < kLength; ++i) {
    hann[i] = 0.5 * (1.0 - std::cos(2.0 * M_PI * (i + 0.5) / kLength));
    energy += hann[i] * hann[i];
  }
  std::array<std::vector<double>, 3> x;
  for (auto& v : x) v.resize(kLength);
  for (int w = 0; w < windows; ++w) {
    for (std::size_t i = 0; i < kLength; ++i) {
      gusts.advance(step, Va);
      for (std::size_t axis = 0; axis < 3; ++axis) x[axis][i] = hann[i] * gusts.gust()[axis];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t f = 0; f < frequencies.size(); ++f) {
        // Goertzel's recursion.
        const double c = 2.0 * std::cos(frequencies[f] * step);
        double s1 = 0.0, s2 = 0.0;
        for (const double value : x[axis]) {
          const double s0 = value + c * s1 - s2;
          s2 = s1;
          s1 = s0;
        }
        power[axis][f] += step * (s1 * s1 + s2 * s2 - c * s1 * s2) / energy / windows;
      }
    }
  }
  return power;
}

/// Power of the printed transfer functions for white noise of unit density.
double spectrum_u(double w, double L, double sigma, double Va) {
  const double b = Va / L;
  return sigma * sigma * 2.0 * b / (w * w + b * b);
}
double spectrum_v(double w, double L, double sigma, double Va) {
  const double b = Va / L;
  return sigma * sigma * 3.0 * b * (w * w + b * b / 3.0) / ((w * w + b * b) * (w * w + b * b));
}

/// Bands of eight frequencies each, as a ratio of measured to printed power.
void expect_spectrum(int windows) {
  const DrydenSettings settings{200, 200, 50, 2.12, 2.12, 1.4};
  constexpr double kStep = 0.02, kVa = 20.0;
  const double resolution = 2.0 * M_PI / (1024 * kStep);
  std::vector<double> frequencies;
  // From the twelfth frequency on: the Hann window smooths a spectrum that falls with 1/k^2 up by about 1/k^2, 2 % at
  // the fourth to eleventh. Below an eighth of the Nyquist frequency, where aliasing adds less than 1 %.
  for (int band = 0; band < 6; ++band) {
    for (int k = 0; k < 8; ++k) frequencies.push_back(resolution * (12 + 8 * band + k));
  }
  const auto power = periodogram(settings, kStep, kVa, windows, frequencies);
  // Neighbouring bins of a Hann window go together: about half of the values of a band count.
  const double bound = 4.0 / std::sqrt(4.0 * windows) + 0.01;
  for (std::size_t band = 0; band < 6; ++band) {
    std::array<double, 3> ratio{};
    for (std::size_t k = 8 * band; k < 8 * band + 8; ++k) {
      const double w = frequencies[k];
      ratio[0] += power[0][k] / spectrum_u(w, 200, 2.12, kVa) / 8;
      ratio[1] += power[1][k] / spectrum_v(w, 200, 2.12, kVa) / 8;
      ratio[2] += power[2][k] / spectrum_v(w, 50, 1.4, kVa) / 8;
    }
    for (const double r : ratio) EXPECT_NEAR(r, 1.0, bound) << "band " << band;
  }
}

TEST(Dryden, HasThePrintedSpectrum) { expect_spectrum(400); }

// One long run: spectrum to 2.5 %, and the covariance of the stationary state kept over it.
TEST(DrydenSoak, KeepsItsSpectrumAndCovarianceOverALongRun) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "a long run: VERIDYN_SOAK=1, or make soak";
  expect_spectrum(20000);
  const DrydenSettings settings{50, 50, 50, 1.0, 2.0, 1.4};
  DrydenGusts gusts(settings, numerics::RandomStream(8, "long"));
  std::array<double, 6> sum{};
  constexpr int kSteps = 20'000'000;
  for (int i = 0; i < kSteps; ++i) {
    gusts.advance(0.1, 20.0);
    const auto g = gusts.gust();
    const std::array<double, 6> products{g[0] * g[0], g[1] * g[1], g[2] * g[2], g[0] * g[1], g[0] * g[2], g[1] * g[2]};
    for (std::size_t k = 0; k < 6; ++k) sum[k] += products[k] / kSteps;
  }
  // 2e6 s at a correlation time of 2.5 s: 4e5 independent samples, 0.22 % of a variance; four standard errors.
  EXPECT_NEAR(sum[0], 1.0, 0.009);
  EXPECT_NEAR(sum[1], 4.0, 0.036);
  EXPECT_NEAR(sum[2], 1.96, 0.018);
  for (std::size_t k = 3; k < 6; ++k) EXPECT_NEAR(sum[k], 0.0, 4.0 * 2.8 / std::sqrt(4e5));
}

TEST(Dryden, ReadsNamedSettingsAndNumbers) {
  const Study study = Study::parse(
      "a = \"low_moderate\"\nb = { Lu = 100, Lw = 30, sigma_u = 2, sigma_w = \"3.6 km/h\" }\nc = \"low_moderat\"\n",
      "s.toml");
  EXPECT_EQ(read_dryden(study.root(), "a").sigma_w, 1.4);
  const DrydenSettings b = read_dryden(study.root(), "b");
  EXPECT_EQ(b.Lv, 100);
  EXPECT_EQ(b.sigma_v, 2);
  EXPECT_NEAR(b.sigma_w, 1.0, 1e-15);
  EXPECT_TRUE(read_dryden(study.root(), "absent").calm());
  try {
    static_cast<void>(read_dryden(study.root(), "c"));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "s.toml:3: c: unknown turbulence 'low_moderat' (did you mean 'low_moderate'?)");
  }
}

}  // namespace
}  // namespace veridyn::aircraft
