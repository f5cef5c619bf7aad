#include "veridyn/aircraft/dryden.hpp"

#include <Eigen/Core>

#include "veridyn/aircraft/wind.hpp"
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

TEST(Dryden, ReadsPublishedAndOwnSettings) {
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

TEST(Wind, GrowsWithHeightAndDriftsWithItsVariance) {
  WindSettings s;
  s.mean = {7, 0, 0};
  s.shear_exponent = 1.0 / 7.0;
  EXPECT_NEAR(Wind(s, numerics::RandomStream(1, "w")).at(80.0).x(), 7 * std::pow(8.0, 1.0 / 7.0), 1e-12);
  s.shear_exponent = 0.0;
  s.drift_sigma = 0.5;
  s.drift_time = 10.0;
  // 4000 independent ends: relative standard error of the variance sqrt(2/8000) = 1.6 % with both components.
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    Wind wind(s, numerics::RandomStream(seed, "w"));
    for (int i = 0; i < 20; ++i) wind.advance(5.0);
    const Eigen::Vector3d w = wind.at(50.0);
    sum += (w.x() - 7) * (w.x() - 7) + w.y() * w.y();
  }
  EXPECT_NEAR(sum / 8000, 0.25, 4 * 0.016 * 0.25);
}

}  // namespace
}  // namespace veridyn::aircraft
