#include "veridyn/estimation/uncertainty/damped_cosine.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

struct Samples {
  std::vector<double> t, y;
};

Samples swing(double w, double s, double noise, std::uint64_t seed = 1, double begin = 100.0, double length = 40.0) {
  numerics::RandomStream random(seed, "swing");
  Samples samples;
  for (double t = 0.0; t < length; t += 0.02 + 0.01 * random.uniform()) {
    samples.t.push_back(begin + t);
    samples.y.push_back(0.3 + std::exp(-s * t) * (0.2 * std::cos(w * t) - 0.1 * std::sin(w * t)) +
                        noise * random.normal());
  }
  return samples;
}

TEST(DampedCosine, RecoversExactSamplesAtUnevenStamps) {
  for (const double w : {0.7, 3.4, 21.0}) {
    const Samples x = swing(w, 0.05, 0.0);
    const DampedCosine fit = fit_damped_cosine(x.t, x.y);
    ASSERT_TRUE(fit.usable()) << to_string(fit.end);
    EXPECT_NEAR(fit.damped_frequency, w, 1e-9);
    EXPECT_NEAR(fit.decay, 0.05, 1e-9);
    EXPECT_NEAR(fit.cosine, 0.2, 1e-9);
    EXPECT_NEAR(fit.sine, -0.1, 1e-9);
    EXPECT_NEAR(fit.offset, 0.3, 1e-9);
    EXPECT_NEAR(fit.undamped_frequency(), std::sqrt(w * w + 0.0025), 1e-9);
    EXPECT_NEAR(fit(x.t[17]), x.y[17], 1e-9);
  }
}

TEST(DampedCosine, StatesItsFrequencyErrorAsWideAsItIs) {
  // 50 seeds: mean of (error/sigma)^2 is 1 with standard error sqrt(2/50) = 0.2; two and a half of them for the fixed
  // seeds.
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Samples x = swing(3.0, 0.05, 0.03, seed);
    const DampedCosine fit = fit_damped_cosine(x.t, x.y);
    ASSERT_TRUE(fit.usable());
    sum += std::pow((fit.damped_frequency - 3.0) / fit.sigma_frequency, 2) / 50.0;
  }
  EXPECT_NEAR(sum, 1.0, 0.5);
}

TEST(DampedCosine, RefusesWhatIsNoOscillation) {
  const Samples slow = swing(0.3, 0.01, 0.0);  // two cycles
  EXPECT_EQ(fit_damped_cosine(slow.t, slow.y).end, DampedCosineEnd::kNoOscillation);
  Samples noise = swing(3.0, 0.05, 0.0);
  numerics::RandomStream random(1, "noise");
  for (double& y : noise.y) y = random.normal();
  EXPECT_EQ(fit_damped_cosine(noise.t, noise.y).end, DampedCosineEnd::kNoOscillation);
  EXPECT_EQ(fit_damped_cosine(std::vector<double>(10, 1.0), std::vector<double>(10, 1.0)).end,
            DampedCosineEnd::kTooFewSamples);
  std::vector<double> constant(100, 2.0), t(100);
  for (std::size_t i = 0; i < 100; ++i) t[i] = 0.1 * static_cast<double>(i);
  EXPECT_FALSE(fit_damped_cosine(t, constant).usable());
  Samples holes = swing(3.0, 0.05, 0.0);
  for (std::size_t i = 0; i < holes.y.size(); i += 3) holes.y[i] = std::nan("");
  EXPECT_NEAR(fit_damped_cosine(holes.t, holes.y).damped_frequency, 3.0, 1e-9);
}

}  // namespace
}  // namespace veridyn::estimation
