#include "veridyn/numerics/theil_shares.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::numerics {
namespace {

TEST(TheilShares, NameAnOffsetBiasAWrongGainVarianceAndTheRestCovariance) {
  // Sine and cosine over whole periods: means 0, standard deviations 1/sqrt(2), correlation 0.
  std::vector<double> sine, cosine, shifted, doubled;
  for (int k = 0; k < 1000; ++k) {
    const double x = 2.0 * M_PI * k / 100.0;
    sine.push_back(std::sin(x));
    cosine.push_back(std::cos(x));
    shifted.push_back(std::sin(x) + 0.3);
    doubled.push_back(2.0 * std::sin(x));
  }
  const TheilShares offset = theil_shares(sine, shifted), gain = theil_shares(sine, doubled),
                    shape = theil_shares(sine, cosine);
  EXPECT_NEAR(offset.bias, 1.0, 1e-12);
  EXPECT_NEAR(gain.variance, 1.0, 1e-12);
  EXPECT_NEAR(shape.covariance, 1.0, 1e-12);
  // Offset 0.3 of twice the sine: 0.09 of bias and (1/sqrt(2))^2 = 0.5 of variance.
  for (double& v : doubled) v += 0.3;
  const TheilShares both = theil_shares(sine, doubled);
  EXPECT_NEAR(both.bias, 0.09 / 0.59, 1e-12);
  EXPECT_NEAR(both.variance, 0.50 / 0.59, 1e-12);
}

TEST(TheilShares, AddUpToOne) {
  RandomStream random(3, "theil");
  std::vector<double> z, y;
  for (int k = 0; k < 500; ++k) {
    z.push_back(random.normal());
    y.push_back(0.4 * z.back() + 0.2 * random.normal() - 1.0);
  }
  z[7] = std::nan("");  // such pairs do not count
  const TheilShares s = theil_shares(z, y);
  EXPECT_NEAR(s.bias + s.variance + s.covariance, 1.0, 1e-12);
  EXPECT_GT(s.bias, 0.5);
}

TEST(TheilShares, AreNotThereWithoutAnErrorAndRefuseUnequalSizes) {
  const std::vector<double> z{1.0, 2.0}, one{1.0};
  EXPECT_TRUE(std::isnan(theil_shares(z, z).bias));
  EXPECT_TRUE(std::isnan(theil_shares({}, {}).covariance));
  EXPECT_THROW((void)theil_shares(z, one), InputError);
}

}  // namespace
}  // namespace veridyn::numerics
