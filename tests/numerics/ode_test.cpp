#include "veridyn/numerics/ode.hpp"

#include <cmath>

namespace veridyn::numerics {
namespace {

using Eigen::Vector2d;

// x'' = -x + cos(2 t): closed form x = (4/3) cos t - (1/3) cos 2t for x(0) = 1, x'(0) = 0.
Vector2d forced(double t, const Vector2d& x) { return {x(1), -x(0) + std::cos(2 * t)}; }
double forced_solution(double t) { return 4.0 / 3.0 * std::cos(t) - std::cos(2 * t) / 3.0; }

double error_with(int steps) {
  Vector2d x(1, 0);
  const double h = 3.0 / steps;
  for (int i = 0; i < steps; ++i) x = runge_kutta_4_step(forced, i * h, x, h);
  return std::abs(x(0) - forced_solution(3.0));
}

TEST(RungeKutta4, ConvergesWithTheFourthPowerOfTheStep) {
  const double order = std::log2(error_with(40) / error_with(80));
  EXPECT_NEAR(order, 4.0, 0.15);
  EXPECT_LT(error_with(80), 1e-6);
}

TEST(RungeKutta4, IntegratesCubicsInTimeExactly) {
  Eigen::Matrix<double, 1, 1> x(0.0);
  x = runge_kutta_4_step([](double t, const auto&) { return Eigen::Matrix<double, 1, 1>(4 * t * t * t); }, 0.0, x, 2.0);
  EXPECT_NEAR(x(0), 16.0, 1e-13);
}

// The two other forms against the step itself, which they follow to rounding.
TEST(RungeKutta4, GoesOnFromAKnownRate) {
  const double t = 0.7, h = 0.1;
  const Vector2d x(0.3, -1.2);
  const auto rate = [&](RungeKuttaMoment moment, const Vector2d& at) {
    return forced(moment == RungeKuttaMoment::kMiddle ? t + 0.5 * h : t + h, at);
  };
  const Vector2d expected = runge_kutta_4_step(forced, t, x, h);
  EXPECT_EQ(runge_kutta_4_from(forced(t, x), rate, x, h), expected);
  Vector2d in_place = x, k;
  const auto stage = [&](RungeKuttaMoment moment, const Vector2d& at) -> const Vector2d& {
    return k = rate(moment, at);
  };
  runge_kutta_4_in_place<2>(forced(t, x), stage, h, in_place);
  EXPECT_LT((in_place - expected).norm(), 1e-15);
}

// The second entry is held, the first is driven by it: x' = y.
TEST(RungeKutta4, LeavesEntriesThatDoNotMove) {
  Vector2d x(1.0, 2.0), k;
  const auto stage = [&](RungeKuttaMoment, Vector2d& at) -> const Vector2d& { return k = Vector2d(at(1), 7.0); };
  runge_kutta_4_in_place<1>(Vector2d(2.0, 7.0), stage, 0.5, x);
  EXPECT_NEAR(x(0), 2.0, 1e-15);
  EXPECT_EQ(x(1), 2.0);
}

TEST(RungeKutta4, TakesStagesAsTheRateCorrectsThem) {
  Vector2d x(1.0, 0.0), k;
  const auto stopped = [&](RungeKuttaMoment, Vector2d& at) -> const Vector2d& {
    at(0) = std::max(at(0), 0.95);
    return k = Vector2d(-at(0), 0.0);
  };
  runge_kutta_4_in_place<2>(Vector2d(-1.0, 0.0), stopped, 0.3, x);
  EXPECT_NEAR(x(0), 1.0 - 0.05 * (1.0 + 2.0 * 0.95 + 2.0 * 0.95 + 0.95), 1e-15);
}

}  // namespace
}  // namespace veridyn::numerics
