#include "veridyn/estimation/regression/frequency_domain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using testing_support::correlated_noise;

// Integral of t^n exp(-s t) over [0, T] by its recursion, s = j omega.
Complex moment(int n, Complex s, double T) {
  const Complex e = std::exp(-s * T);
  Complex value = (1.0 - e) / s;
  for (int i = 1; i <= n; ++i) value = (static_cast<double>(i) * value - std::pow(T, i) * e) / s;
  return value;
}

TEST(FiniteFourierTransform, IsExactForCubicPolynomialsAtAnyFrequency) {
  const double step = 0.05;
  std::vector<double> t, cubic;
  for (int k = 0; k <= 60; ++k) {
    t.push_back(step * k);
    cubic.push_back(1.0 - 2.0 * t.back() + 0.5 * std::pow(t.back(), 2) + 0.3 * std::pow(t.back(), 3));
  }
  // From the series for small angles through the closed forms to Nyquist (10 Hz).
  const std::vector<double> f{0.05, 0.25, 0.31, 0.33, 1.0, 3.3, 9.9};
  const Eigen::VectorXcd X = finite_fourier_transform(cubic, step, f);
  for (std::size_t i = 0; i < f.size(); ++i) {
    const Complex s(0.0, 2.0 * std::numbers::pi * f[i]);
    const Complex exact =
        moment(0, s, 3.0) - 2.0 * moment(1, s, 3.0) + 0.5 * moment(2, s, 3.0) + 0.3 * moment(3, s, 3.0);
    EXPECT_LT(std::abs(X(i) - exact), 2e-11) << f[i];
  }
}

TEST(FiniteFourierTransform, ConvergesWithTheFourthPowerOfTheStep) {
  // x = exp(-t) sin(3 t): transform by partial fractions, Im of the integral of exp((-1 + 3j - s) t).
  const double T = 4.0, f = 0.7;
  const Complex s(0.0, 2.0 * std::numbers::pi * f);
  const auto part = [&](Complex a) { return (std::exp((a - s) * T) - 1.0) / (a - s); };
  const Complex exact = (part(Complex(-1.0, 3.0)) - part(Complex(-1.0, -3.0))) / Complex(0.0, 2.0);
  std::vector<double> errors;
  for (const int N : {80, 160}) {
    std::vector<double> x;
    for (int k = 0; k <= N; ++k) {
      const double t = T * k / N;
      x.push_back(std::exp(-t) * std::sin(3.0 * t));
    }
    errors.push_back(std::abs(finite_fourier_transform(x, T / N, std::vector<double>{f})(0) - exact));
  }
  EXPECT_LT(errors[1], 1e-6);
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 4.0, 0.5);
}

/// Regressors with power in the band, z = X theta + noise, in segments of unlike length.
RegressionData flight_like(unsigned seed, double noise, double rho) {
  std::mt19937_64 generator(seed);
  const Index N = 3000;
  RegressionData data;
  data.regressors.resize(N, 3);
  data.regressors.col(0).setOnes();
  data.regressors.col(1) = correlated_noise(generator, N, 0.95);
  data.regressors.col(2) = 0.6 * data.regressors.col(1) + 0.8 * correlated_noise(generator, N, 0.95);
  data.regressand = data.regressors * Eigen::Vector3d(0.4, -1.1, 0.6) + noise * correlated_noise(generator, N, rho);
  data.parameter_names = {"constant", "a", "b"};
  for (Index k = 0; k < N; ++k) data.segment.push_back(k < 500 ? 0 : (k < 1700 ? 1 : 2));
  return data;
}

TEST(FrequencyEquationError, AgreesWithTheTimeDomainWithinItsErrors) {
  const RegressionData data = flight_like(1, 0.5, 0.7);
  const FrequencyEstimate f = frequency_equation_error(data, 0.02, {.low_Hz = 0.1, .high_Hz = 4.0});
  ASSERT_TRUE(f.estimate.usable()) << f.estimate.message;
  EXPECT_EQ(f.segments, 3);
  EXPECT_EQ(f.left_out, std::vector<std::string>{"constant"});
  const RegressionEstimate time = estimate(data, Method::kOls);
  for (const char* name : {"a", "b"}) {
    const double gap = f.estimate.find(name)->value - time.find(name)->value;
    EXPECT_LT(std::abs(gap), 3.0 * std::hypot(f.estimate.find(name)->sigma, time.find(name)->sigma)) << name;
  }
}

TEST(FrequencyEquationError, IsExactWithoutNoiseWhateverBiasAndDrift) {
  RegressionData data = flight_like(2, 0.0, 0.0);
  for (Index k = 0; k < data.rows(); ++k) {
    // Each segment its own bias and drift, in z and in a regressor.
    const double t = 0.02 * static_cast<double>(k);
    const int s = data.segment[k];
    data.regressand(k) += 3.0 * s - 0.2 * (s + 1) * t;
    data.regressors(k, 1) += 0.5 - 0.1 * t * s;
  }
  const FrequencyEstimate f = frequency_equation_error(data, 0.02, {.low_Hz = 0.05, .high_Hz = 4.0});
  ASSERT_TRUE(f.estimate.usable());
  EXPECT_NEAR(f.estimate.find("a")->value, -1.1, 1e-9);
  EXPECT_NEAR(f.estimate.find("b")->value, 0.6, 1e-9);
  EXPECT_GT(std::abs(estimate(data, Method::kOls).find("a")->value + 1.1), 0.05);  // where least squares is lost
}

double coverage(double rho, int seeds) {
  int held = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const FrequencyEstimate f = frequency_equation_error(flight_like(static_cast<unsigned>(100 + seed), 0.5, rho), 0.02,
                                                         {.low_Hz = 0.1, .high_Hz = 4.0});
    const Parameter &a = *f.estimate.find("a"), &b = *f.estimate.find("b");
    held += (a.low95 < -1.1 && -1.1 < a.high95) + (b.low95 < 0.6 && 0.6 < b.high95);
  }
  return held / (2.0 * seeds);
}

TEST(FrequencyEquationError, IntervalsCoverTheTruthUnderWhiteAndColouredResiduals) {
  // Standard error of the share over 2 x 150 trials: 0.013.
  EXPECT_NEAR(coverage(0.0, 150), 0.95, 0.04);
  EXPECT_NEAR(coverage(0.95, 150), 0.95, 0.04);
}

TEST(FrequencyEquationError, SaysWhatIsWrong) {
  const RegressionData data = flight_like(1, 0.1, 0.0);
  const auto message = [&](double step, const FrequencyOptions& options) -> std::string {
    try {
      static_cast<void>(frequency_equation_error(data, step, options));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message(0.02, {.low_Hz = 0.1, .high_Hz = 30.0}),
            "frequency_domain.high: is 30 Hz; must be above low = 0.1 Hz and at most 25 Hz, half the sampling rate");
  EXPECT_EQ(message(0.02, {.low_Hz = 0.0}), "frequency_domain.low: is 0 Hz; must be > 0");
  EXPECT_EQ(message(std::nan(""), {}), "frequency_domain.step: is nan s; must be > 0");
  // A band between two frequencies of every segment.
  const FrequencyEstimate none = frequency_equation_error(data, 0.02, {.low_Hz = 0.1301, .high_Hz = 0.1302});
  EXPECT_EQ(none.estimate.termination, EstimateTermination::kTooFewRows);
  EXPECT_THAT(none.estimate.message, ::testing::HasSubstr("0 frequencies between 0.1301 and 0.1302 Hz"));
}

}  // namespace
}  // namespace veridyn::estimation
