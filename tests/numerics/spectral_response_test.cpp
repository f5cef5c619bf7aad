#include "veridyn/numerics/spectral_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::numerics {
namespace {

std::vector<double> white(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed, "white");
  std::vector<double> x(count);
  for (double& value : x) value = random.normal();
  return x;
}

// y_k = x_k + 0.5 x_{k-1}: H = 1 + 0.5 exp(-j w); with white noise of known size added to y, the coherence is known.
TEST(SpectralResponse, FindsResponseAndCoherenceOfAFilterInNoise) {
  const std::vector<double> x = white(60000, 1), noise = white(60000, 2);
  std::vector<double> y(x.size());
  for (std::size_t k = 1; k < x.size(); ++k) y[k] = x[k] + 0.5 * x[k - 1] + 0.4 * noise[k];
  const std::vector<ResponseEstimate> found = spectral_response(x, y, 100.0, 256, 1.0, 45.0);
  double chi2 = 0.0, coherence2 = 0.0;
  for (const ResponseEstimate& one : found) {
    const std::complex<double> exact = 1.0 + 0.5 * std::polar(1.0, -2.0 * std::numbers::pi * one.frequency_Hz / 100.0);
    const double coherence = std::norm(exact) / (std::norm(exact) + 0.16);
    // Standard deviation sqrt(2 c) (1 - c)/sqrt(n) (Bendat & Piersol 2010, eq. 9.82), about 445 independent segments.
    const double sigma = std::sqrt(2.0 * coherence / 445.0) * (1.0 - coherence);
    coherence2 += std::pow((one.coherence - coherence) / sigma, 2);
    chi2 += std::norm((one.response - exact) / (std::abs(exact) * one.sigma));
  }
  // |error/sigma|^2 has two degrees of freedom a frequency, so its mean is 2.
  EXPECT_NEAR(chi2 / static_cast<double>(found.size()), 2.0, 0.6);
  EXPECT_NEAR(coherence2 / static_cast<double>(found.size()), 1.0, 0.4);
}

TEST(SpectralResponse, RefusesRecordsThatCannotTell) {
  const std::vector<double> x(100, 0.0);
  EXPECT_THROW((void)spectral_response(x, std::vector<double>(99, 0.0), 10.0, 32, 1.0, 4.0), InputError);
  EXPECT_THROW((void)spectral_response(x, x, 10.0, 200, 1.0, 4.0), InputError);
  EXPECT_THROW((void)spectral_response(x, x, 10.0, 32, 1.0, 6.0), InputError);
  EXPECT_TRUE(spectral_response(x, x, 10.0, 32, 1.0, 4.0).empty());  // no input, no response
}

}  // namespace
}  // namespace veridyn::numerics
