#include "veridyn/numerics/trigonometry.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace veridyn::numerics {
namespace {

constexpr double kUlp = std::numeric_limits<double>::epsilon();

TEST(Trigonometry, GivesSineAndCosineAsLongDoubleDoes) {
  std::mt19937_64 generator(1);
  for (const double most : {1e-8, 0.5, 1.0, 7.0, 1e3, 1e5, 1e7}) {
    std::uniform_real_distribution<double> any(-most, most);
    double worst = 0.0;
    for (int k = 0; k < 50000; ++k) {
      const double x = any(generator);
      const auto [sine, cosine] = sine_cosine(x);
      const auto wide = static_cast<long double>(x);
      worst = std::max({worst, static_cast<double>(std::abs(sine - std::sin(wide))),
                        static_cast<double>(std::abs(cosine - std::cos(wide)))});
    }
    EXPECT_LE(worst, kUlp) << most;
  }
  EXPECT_EQ(sine_cosine(0.0).sin, 0.0);
  EXPECT_EQ(sine_cosine(0.0).cos, 1.0);
  EXPECT_TRUE(std::isnan(sine_cosine(std::nan("")).sin));
}

TEST(Trigonometry, IsOddAndEvenToTheLastBit) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> any(-100.0, 100.0);
  for (int k = 0; k < 20000; ++k) {
    const double x = any(generator);
    EXPECT_EQ(sine_cosine(-x).sin, -sine_cosine(x).sin);
    EXPECT_EQ(sine_cosine(-x).cos, sine_cosine(x).cos);
  }
}

TEST(Trigonometry, GivesArcTangentsAsLongDoubleDoes) {
  std::mt19937_64 generator(3);
  for (const double most : {0.35, 0.36, 10.0}) {  // all in the series, some beyond it, most beyond
    std::uniform_real_distribution<double> any(-most, most);
    double worst = 0.0;
    for (int k = 0; k < 50000; ++k) {
      const FourAngles<double> x(any(generator), any(generator), any(generator), any(generator));
      const FourAngles<double> angles = arc_tangents<double>(x), reflected = arc_tangents<double>(-x);
      for (Eigen::Index i = 0; i < 4; ++i) {
        const long double exact = std::atan(static_cast<long double>(x[i]));
        worst = std::max(worst, static_cast<double>(std::abs((angles[i] - exact) / exact)));
        EXPECT_EQ(reflected[i], -angles[i]);
      }
    }
    EXPECT_LE(worst, kUlp) << most;
  }
}

TEST(Trigonometry, CarriesDerivatives) {
  using Jet = ceres::Jet<double, 1>;
  const Jet x(0.3, 0);
  EXPECT_NEAR(sine_cosine(x).sin.v(0), std::cos(0.3), 1e-15);
  EXPECT_NEAR(sine_cosine(x).cos.v(0), -std::sin(0.3), 1e-15);
  EXPECT_NEAR(arc_tangents<Jet>(FourAngles<Jet>(x, x, x, x))[2].v(0), 1.0 / 1.09, 1e-15);
}

}  // namespace
}  // namespace veridyn::numerics
