#include "veridyn/aircraft/simulation/gust_gradients.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>

namespace veridyn::aircraft {
namespace {

constexpr double kSpan = 3.0, kVa = 20.0;
const DrydenSettings kAir{.Lu = 200, .Lv = 200, .Lw = 50, .sigma_u = 2.12, .sigma_v = 2.12, .sigma_w = 1.4};

/// Spectra of MIL-F-8785C, one-sided over spatial frequency W [rad/m].
double spectrum_of_gust(double W, double L, double sigma) {
  const double x = L * W * L * W;
  return sigma * sigma * L / M_PI * (1.0 + 3.0 * x) / ((1.0 + x) * (1.0 + x));
}
double spectrum_of_q(double W) {
  return W * W / (1.0 + std::pow(4.0 * kSpan * W / M_PI, 2)) * spectrum_of_gust(W, kAir.Lw, kAir.sigma_w);
}
double spectrum_of_r(double W) {
  return W * W / (1.0 + std::pow(3.0 * kSpan * W / M_PI, 2)) * spectrum_of_gust(W, kAir.Lv, kAir.sigma_v);
}
double spectrum_of_p(double W) {
  return kAir.sigma_w * kAir.sigma_w / kAir.Lw * 0.8 * std::cbrt(M_PI * kAir.Lw / (4.0 * kSpan)) /
         (1.0 + std::pow(4.0 * kSpan * W / M_PI, 2));
}

/// Over all W, by W = tan x.
double integral(const std::function<double(double)>& spectrum) {
  constexpr int kN = 200000;
  double sum = 0.0;
  for (int i = 0; i < kN; ++i) {
    const double x = (i + 0.5) * 0.5 * M_PI / kN;
    sum += spectrum(std::tan(x)) / (std::cos(x) * std::cos(x)) * 0.5 * M_PI / kN;
  }
  return sum;
}

// Standard errors: the rates are correlated over some 4 m of the way, and so of 80 km there are 20 000 independent
// values, of which a variance has 1 %. Bound: four of these.
TEST(GustGradients, HaveTheVarianceOfThePublishedSpectra) {
  DrydenGusts gusts(kAir, numerics::RandomStream(3, "gusts"));
  GustGradients gradients(kAir, kSpan, numerics::RandomStream(3, "gradients"));
  std::array<double, 3> square{};
  double lagged = 0.0, before_p = 0.0;
  constexpr int kSteps = 800000;
  constexpr double kStep = 0.005;
  for (int k = 0; k < kSteps; ++k) {
    const std::array<double, 3> before = gusts.gust();
    gusts.advance(kStep, kVa);
    gradients.advance(kStep, kVa, before, gusts.gust());
    const std::array<double, 3> rates = gradients.rates();
    for (std::size_t i = 0; i < 3; ++i) square[i] += rates[i] * rates[i] / kSteps;
    lagged += before_p * rates[0] / kSteps;
    before_p = rates[0];
  }
  EXPECT_NEAR(square[0] / integral(spectrum_of_p), 1.0, 0.04);
  EXPECT_NEAR(square[1] / integral(spectrum_of_q), 1.0, 0.04);
  EXPECT_NEAR(square[2] / integral(spectrum_of_r), 1.0, 0.04);
  EXPECT_NEAR(lagged / square[0], std::exp(-kStep * kVa * M_PI / (4.0 * kSpan)), 1e-3);
}

// Through a sinusoidal field: the transfer functions -+s/(1 + l s), whose sign follows from the field alone. A point
// ahead by x meets a gust that is larger by x dw/dx, as if the aircraft pitched up by q = dw/dx, which moves the point
// by -q x along z; and dv/dx as if it yawed by r = -dv/dx, which moves it by r x along y.
TEST(GustGradients, AreTheGradientsOfTheFieldForWavesLongerThanTheSpan) {
  for (const double W : {0.01, 0.1, 0.5}) {
    GustGradients gradients(kAir, kSpan, numerics::RandomStream(1, "gradients"));
    const auto gust = [W](double s) { return std::array<double, 3>{0.0, std::sin(W * s), std::cos(W * s)}; };
    constexpr double kStep = 0.001;
    double s = 0.0;
    for (int k = 0; k < 100000; ++k, s += kStep * kVa) gradients.advance(kStep, kVa, gust(s), gust(s + kStep * kVa));
    const std::complex<double> i(0.0, 1.0), wave = std::exp(i * W * s);
    const auto filtered = [&](double length) { return i * W / (1.0 + i * W * length) * wave; };
    const std::array<double, 3> rates = gradients.rates();
    EXPECT_NEAR(rates[1], filtered(4.0 * kSpan / M_PI).real(), 1e-4 * W) << W;
    EXPECT_NEAR(rates[2], -filtered(3.0 * kSpan / M_PI).imag(), 1e-4 * W) << W;
    if (W < 0.05) {
      constexpr double kAhead = 1e-3;
      EXPECT_NEAR(rates[1], (gust(s + kAhead)[2] - gust(s)[2]) / kAhead, 0.05 * W);
      EXPECT_NEAR(rates[2], -(gust(s + kAhead)[1] - gust(s)[1]) / kAhead, 0.05 * W);
    }
  }
}

TEST(GustGradients, AreNoneInCalmAir) {
  GustGradients gradients({}, kSpan, numerics::RandomStream(1, "gradients"));
  gradients.advance(0.01, kVa, {}, {});
  EXPECT_EQ(gradients.rates(), (std::array<double, 3>{0.0, 0.0, 0.0}));
}

}  // namespace
}  // namespace veridyn::aircraft
