#include "veridyn/numerics/modulating_kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

// A sine comes out as gain times the sine, its derivatives as the same gain times the exact derivatives.
TEST(ModulatingKernel, GivesDerivativesThroughOneAndTheSameFilter) {
  for (const double rate : {100.0, 30.0}) {
    const ModulatingKernel kernel = modulating_kernel(rate, 2.0);
    // Sums for integrals: 26 and 8 samples in T.
    const double tolerance = rate > 50.0 ? 1e-4 : 3e-4;
    for (const double f : {0.2, 1.0, 2.0}) {
      const double w = 2.0 * M_PI * f, gain = kernel.smooth.gain(f);
      EXPECT_NEAR(kernel.first.gain(f), w * gain, tolerance * w) << rate << " " << f;
      EXPECT_NEAR(kernel.second.gain(f), -w * w * gain, tolerance * w * w) << rate << " " << f;
    }
    EXPECT_NEAR(kernel.smooth.gain(0.0), 1.0, 1e-12);
    EXPECT_NEAR(kernel.smooth.gain(2.0), std::sqrt(0.5), 0.02);
  }
}

TEST(ModulatingKernel, IsExactForParabolas) {
  const ModulatingKernel kernel = modulating_kernel(50.0, 5.0);
  const auto m = static_cast<int>(kernel.smooth.half_width());
  double value = 0.0, slope = 0.0, curvature = 0.0;
  for (int j = -m; j <= m; ++j) {
    const double t = j / 50.0, x = 3.0 + 2.0 * t + 5.0 * t * t;
    const auto i = static_cast<std::size_t>(j + m);
    value += kernel.smooth.taps[i];
    slope += kernel.first.taps[i] * x;
    curvature += kernel.second.taps[i] * (x - 5.0 * t * t);
  }
  EXPECT_NEAR(value, 1.0, 1e-12);
  EXPECT_NEAR(slope, 2.0, 1e-10);
  EXPECT_NEAR(curvature, 0.0, 1e-9);
}

TEST(ModulatingKernel, RefusesACutOffThatTheSamplesCannotCarry) {
  EXPECT_THROW(static_cast<void>(modulating_kernel(30.0, 4.0)), InputError);
  EXPECT_THROW(static_cast<void>(modulating_kernel(30.0, std::nan(""))), InputError);
}

}  // namespace
}  // namespace veridyn::numerics
