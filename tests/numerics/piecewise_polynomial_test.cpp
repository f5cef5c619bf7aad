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

TEST(PiecewisePolynomial, IntegralsAreExactAcrossPiecesAndBeyondThem) {
  // The spline through a cubic is the cubic, straight beyond its ends.
  const auto cubic = [](double x) { return 1.0 + x - 2.0 * x * x + 0.5 * x * x * x; };
  const auto primitive = [](double x) { return x + 0.5 * x * x - 2.0 / 3.0 * x * x * x + 0.125 * x * x * x * x; };
  const std::array<double, 5> x{-1.0, -0.2, 0.5, 1.1, 2.0};
  std::array<double, 5> y{};
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = cubic(x[i]);
  const PiecewisePolynomial f = PiecewisePolynomial::simm_spline(x, y);
  EXPECT_NEAR(f.integral(-0.7, 1.8), primitive(1.8) - primitive(-0.7), 1e-14);
  EXPECT_NEAR(f.integral(1.8, -0.7), primitive(-0.7) - primitive(1.8), 1e-14);
  const double slope = f.evaluate(3.0).slope;
  EXPECT_NEAR(f.integral(2.0, 4.0), 2.0 * y[4] + 2.0 * slope, 1e-13);
  EXPECT_EQ(f.integral(0.3, 0.3), 0.0);
  EXPECT_NEAR(PiecewisePolynomial::constant(2.5).integral(-3.0, 1.0), 10.0, 1e-15);
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

TEST(ContinuedPieces, AreWhatThePiecesSayAndGoOnStraight) {
  const auto f = PiecewisePolynomial::continued_pieces(
      std::vector{0.0, 1.0}, std::vector<std::array<double, 4>>{{2.0, 3.0, 1.0, 0.0}, {5.0, 0.0, 4.0, 2.0}}, 2.0);
  EXPECT_DOUBLE_EQ(f.evaluate(-2.0).value, -4.0);
  EXPECT_DOUBLE_EQ(f.evaluate(-2.0).slope, 3.0);
  EXPECT_DOUBLE_EQ(f.evaluate(0.5).value, 3.75);
  EXPECT_DOUBLE_EQ(f.evaluate(1.0).value, 5.0);  // jumps from 6
  EXPECT_DOUBLE_EQ(f.evaluate(1.5).slope, 5.5);
  EXPECT_DOUBLE_EQ(f.evaluate(2.0).value, 11.0);
  EXPECT_DOUBLE_EQ(f.evaluate(3.0).value, 25.0);
  EXPECT_DOUBLE_EQ(f.evaluate(3.0).slope, 14.0);
  EXPECT_DOUBLE_EQ(f.evaluate(3.0).curvature, 0.0);
}

}  // namespace
}  // namespace veridyn::numerics
