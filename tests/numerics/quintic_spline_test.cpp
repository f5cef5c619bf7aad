#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::numerics {
namespace {

struct Samples {
  std::vector<double> x, y;
};

template <typename F>
Samples uneven(std::size_t n, const F& f) {
  Samples s;
  for (std::size_t i = 0; i < n; ++i) {
    const double u = static_cast<double>(i) / static_cast<double>(n - 1);
    s.x.push_back(u + 0.2 / static_cast<double>(n) * std::sin(7.0 * u));
    s.y.push_back(f(s.x.back()));
  }
  return s;
}

TEST(QuinticSpline, GivesBackAQuinticWithItsDerivatives) {
  const auto f = [](double t) { return 1.0 + t * (2.0 + t * (-3.0 + t * (0.5 + t * (4.0 - 2.0 * t)))); };
  const Samples s = uneven(17, f);
  const PiecewisePolynomial spline = PiecewisePolynomial::quintic_spline(s.x, s.y);
  for (double t = s.x.front(); t <= s.x.back(); t += 0.013) {
    EXPECT_NEAR(spline.evaluate(t).value, f(t), 1e-12);
    EXPECT_NEAR(spline.evaluate(t).slope, 2.0 - 6.0 * t + 1.5 * t * t + 16.0 * std::pow(t, 3) - 10.0 * std::pow(t, 4),
                1e-10);
    EXPECT_NEAR(spline.evaluate(t).curvature, -6.0 + 3.0 * t + 48.0 * t * t - 40.0 * std::pow(t, 3), 1e-8);
  }
}

TEST(QuinticSpline, SecondDerivativeConvergesWithOrderFour) {
  const auto error = [](std::size_t n) {
    const Samples s = uneven(n, [](double t) { return std::sin(6.0 * t); });
    const PiecewisePolynomial spline = PiecewisePolynomial::quintic_spline(s.x, s.y);
    double worst = 0.0;
    for (double t = s.x.front(); t <= s.x.back(); t += 0.0017) {
      worst = std::max(worst, std::abs(spline.evaluate(t).curvature + 36.0 * std::sin(6.0 * t)));
    }
    return worst;
  };
  EXPECT_NEAR(std::log2(error(41) / error(81)), 4.0, 0.7);
}

TEST(QuinticSpline, HoldsItsEndValuesAndTakesFewPoints) {
  const PiecewisePolynomial line = PiecewisePolynomial::quintic_spline(std::vector{0.0, 2.0}, std::vector{1.0, 5.0});
  EXPECT_DOUBLE_EQ(line.evaluate(1.0).value, 3.0);
  EXPECT_DOUBLE_EQ(line.evaluate(3.0).value, 5.0);
  EXPECT_DOUBLE_EQ(line.evaluate(3.0).slope, 0.0);
  EXPECT_DOUBLE_EQ(line.evaluate(-1.0).value, 1.0);
  const PiecewisePolynomial point = PiecewisePolynomial::quintic_spline(std::vector{0.5}, std::vector{7.0});
  EXPECT_DOUBLE_EQ(point.evaluate(0.5).value, 7.0);
  const PiecewisePolynomial cubic =
      PiecewisePolynomial::quintic_spline(std::vector{0.0, 1.0, 2.0, 4.0}, std::vector{0.0, 1.0, 8.0, 64.0});
  EXPECT_NEAR(cubic.evaluate(3.0).value, 27.0, 1e-12);
}

}  // namespace
}  // namespace veridyn::numerics
