#include "veridyn/numerics/piecewise_polynomial.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace veridyn::numerics {
namespace {

TEST(PiecewisePolynomial, DerivativesAreThoseOfAutomaticDifferentiation) {
  const std::array<double, 6> x{-2.0, -1.0, -0.4, 0.3, 1.0, 2.5};
  const std::array<double, 6> y{0.3, -0.2, 0.7, 1.1, 0.9, -0.5};
  const PiecewisePolynomial spline = PiecewisePolynomial::simm_spline(x, y).scaled(1.7);
  for (double t = -3.0; t < 3.5; t += 0.37) {
    const FunctionValue<double> f = spline.evaluate(t);
    const auto jet = spline.evaluate(ceres::Jet<double, 1>(t, 0));
    EXPECT_DOUBLE_EQ(jet.value.v[0], f.slope);
    EXPECT_NEAR(jet.slope.v[0], f.curvature, 1e-13);
  }
}

TEST(PiecewisePolynomial, SplineOfOpenSimIsExactForACubicAndStraightBeyondItsEnds) {
  // With ends that take the third derivative of the cubic through four points, a cubic comes back as itself.
  const auto cubic = [](double t) { return 0.3 - 0.7 * t + 0.2 * t * t + 0.9 * t * t * t; };
  const std::array<double, 5> x{-1.0, -0.2, 0.5, 0.9, 2.0};
  std::array<double, 5> y{};
  for (std::size_t i = 0; i < 5; ++i) y[i] = cubic(x[i]);
  const PiecewisePolynomial spline = PiecewisePolynomial::simm_spline(x, y);
  for (double t = -1.0; t <= 2.0; t += 0.1) EXPECT_NEAR(spline.evaluate(t).value, cubic(t), 1e-13) << t;
  const double end_slope = -0.7 + 0.4 * 2.0 + 2.7 * 4.0;
  EXPECT_NEAR(spline.evaluate(3.0).value, cubic(2.0) + end_slope, 1e-12);
  EXPECT_NEAR(spline.evaluate(3.0).slope, end_slope, 1e-12);
  EXPECT_EQ(spline.evaluate(3.0).curvature, 0.0);
}

TEST(PiecewisePolynomial, NaturalSplinePassesThroughItsPointsWithContinuousCurvature) {
  const std::array<double, 5> x{0.0, 1.0, 1.5, 3.0, 4.0};
  const std::array<double, 5> y{0.0, 2.0, -1.0, 0.5, 0.2};
  const PiecewisePolynomial spline = PiecewisePolynomial::natural_spline(x, y);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(spline.evaluate(x[i]).value, y[i], 1e-13);
    const FunctionValue<double> before = spline.evaluate(x[i] - 1e-9);
    const FunctionValue<double> after = spline.evaluate(x[i] + 1e-9);
    EXPECT_NEAR(before.slope, after.slope, 1e-6);
    EXPECT_NEAR(before.curvature, after.curvature, 1e-6);
  }
  EXPECT_EQ(spline.evaluate(-1.0).curvature, 0.0);
}

TEST(PiecewisePolynomial, PolynomialTakesAscendingPowers) {
  const std::array<double, 3> c{1.0, -2.0, 0.5};
  const FunctionValue<double> f = PiecewisePolynomial::polynomial(c).evaluate(3.0);
  EXPECT_DOUBLE_EQ(f.value, 1.0 - 6.0 + 4.5);
  EXPECT_DOUBLE_EQ(f.slope, -2.0 + 3.0);
  EXPECT_DOUBLE_EQ(f.curvature, 1.0);
  EXPECT_TRUE(PiecewisePolynomial::linear(2.0, 1.0).is_linear());
  EXPECT_EQ(PiecewisePolynomial::constant(4.0).evaluate(9.0).slope, 0.0);
}

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

TEST(HeldPieces, AreWhatThePiecesSayTheRightOneAtABreak) {
  const auto spline = PiecewisePolynomial::held_pieces(
      std::vector{0.0, 1.0}, std::vector<std::array<double, 6>>{{2.0, 3.0}, {5.0, 0.0, 4.0}}, 2.0);
  EXPECT_DOUBLE_EQ(spline.evaluate(-1.0).value, 2.0);
  EXPECT_DOUBLE_EQ(spline.evaluate(0.5).value, 3.5);
  EXPECT_DOUBLE_EQ(spline.evaluate(0.5).slope, 3.0);
  EXPECT_DOUBLE_EQ(spline.evaluate(1.0).slope, 0.0);
  EXPECT_DOUBLE_EQ(spline.evaluate(1.0).curvature, 8.0);
  EXPECT_DOUBLE_EQ(spline.evaluate(1.5).value, 6.0);
  EXPECT_DOUBLE_EQ(spline.evaluate(2.0).slope, 8.0);  // the end belongs to the last piece
  EXPECT_DOUBLE_EQ(spline.evaluate(3.0).value, 9.0);
  EXPECT_DOUBLE_EQ(spline.evaluate(3.0).slope, 0.0);
}

}  // namespace
}  // namespace veridyn::numerics
