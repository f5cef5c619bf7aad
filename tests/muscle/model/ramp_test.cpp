#include "veridyn/muscle/model/ramp.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

TEST(Ramp, MinimumJerkIsItsPolynomialAndRestsOutside) {
  const std::array<Ramp, 1> ramp{Ramp{.start = 0.5, .duration = 2.0, .from = 1.0, .to = 4.0}};
  const numerics::PiecewisePolynomial spline = ramp_spline(ramp);
  for (const double s : {0.0, 0.2, 0.7, 0.999}) {
    const auto f = spline.evaluate(0.5 + 2.0 * s);
    EXPECT_NEAR(f.value, 1.0 + 3.0 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), 1e-14);
    EXPECT_NEAR(f.slope, 1.5 * s * s * (30.0 - 60.0 * s + 30.0 * s * s), 1e-13);
  }
  for (const double t : {-1.0, 0.4, 2.6, 9.0}) {
    EXPECT_EQ(spline.evaluate(t).value, t < 1.0 ? 1.0 : 4.0);
    EXPECT_EQ(spline.evaluate(t).slope, 0.0);
  }
}

TEST(Ramp, BetweenTwoRampsTheCoordinateRests) {
  const std::array<Ramp, 2> ramps{
      Ramp{.start = 0.0, .duration = 1.0, .from = 0.0, .to = 1.0, .shape = RampShape::kLinear},
      Ramp{.start = 1.5, .duration = 1.0, .from = 1.0, .to = -1.0, .shape = RampShape::kHalfSine}};
  const numerics::PiecewisePolynomial spline = ramp_spline(ramps);
  EXPECT_EQ(spline.evaluate(1.2).value, 1.0);
  EXPECT_EQ(spline.evaluate(1.2).slope, 0.0);
  EXPECT_NEAR(spline.evaluate(0.25).value, 0.25, 1e-15);
  EXPECT_NEAR(spline.evaluate(0.25).slope, 1.0, 1e-15);
  // The accuracy that the header promises: 1e-11 of the rise.
  for (const double s : {0.01, 0.3, 0.77}) EXPECT_NEAR(spline.evaluate(1.5 + s).value, std::cos(kPi * s), 2e-11);
  EXPECT_EQ(resting_spline(0.3).evaluate(7.0).value, 0.3);
  EXPECT_EQ(resting_spline(0.3).evaluate(-7.0).slope, 0.0);
}

}  // namespace
}  // namespace veridyn::muscle
