#include "veridyn/numerics/runge_kutta_nystrom.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::numerics {
namespace {

// A pendulum of large swings, x'' = -sin x, against itself with far finer steps; and x'' = -x against its closed form.
struct Swing {
  double x = 0.0, v = 0.0;
};

template <typename Force>
Swing swung(const Force& force, Swing from, double duration, int steps) {
  const double h = duration / steps;
  double x[1] = {from.x}, u[1] = {h * from.v};
  nystrom_5_steps<1>([&](const double* at, double* k) { k[0] = h * h * force(at[0]); }, steps, x, u);
  return {x[0], u[0] / h};
}

TEST(Nystrom5, ConvergesWithTheFifthPowerOfTheStep) {
  const auto pendulum = [](double x) { return -std::sin(x); };
  const Swing exact = swung(pendulum, {2.0, 0.5}, 5.0, 4000);
  const Swing coarse = swung(pendulum, {2.0, 0.5}, 5.0, 50), fine = swung(pendulum, {2.0, 0.5}, 5.0, 100);
  EXPECT_NEAR(std::log2(std::abs((coarse.x - exact.x) / (fine.x - exact.x))), 5.0, 0.3);
  EXPECT_NEAR(std::log2(std::abs((coarse.v - exact.v) / (fine.v - exact.v))), 5.0, 0.3);
}

TEST(Nystrom5, IsTheClosedFormOfAnOscillator) {
  const Swing end = swung([](double x) { return -x; }, {1.0, 0.25}, 3.0, 200);
  EXPECT_NEAR(end.x, std::cos(3.0) + 0.25 * std::sin(3.0), 1e-10);
  EXPECT_NEAR(end.v, -std::sin(3.0) + 0.25 * std::cos(3.0), 1e-10);
}

TEST(Nystrom5, StepsComponentsTogether) {
  // A circle: x'' = -x/r^3 in the plane.
  const double h = 0.01;
  double x[2] = {1.0, 0.0}, u[2] = {0.0, h};
  const auto gravity = [&](const double* at, double* k) {
    const double r = std::hypot(at[0], at[1]);
    for (int c = 0; c < 2; ++c) k[c] = -h * h * at[c] / (r * r * r);
  };
  nystrom_5_steps<2>(gravity, 100, x, u);
  EXPECT_NEAR(x[0], std::cos(1.0), 1e-11);
  EXPECT_NEAR(x[1], std::sin(1.0), 1e-11);
}

}  // namespace
}  // namespace veridyn::numerics
