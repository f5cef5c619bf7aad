#include "veridyn/numerics/dormand_prince.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/integrate_adaptive.hpp"

namespace veridyn::numerics {
namespace {

const auto kNothing = [](double, double) { return true; };

// A pendulum whose frequency depends on time: no closed form, so compared with itself at tight tolerance.
struct Pendulum {
  template <typename Scalar>
  bool operator()(double t, const Scalar* x, Scalar* rate) const {
    using std::sin;
    rate[0] = x[1];
    rate[1] = -(9.0 + 2.0 * std::sin(3.0 * t)) * sin(x[0]);
    return true;
  }
};

std::array<double, 2> pendulum_at(double end, double tolerance) {
  DormandPrince<double> stepper(2);
  std::array<double, 2> x{1.2, 0.3};
  double t = 0.0;
  EXPECT_EQ(stepper.advance(Pendulum(), t, x.data(), end, std::array{1.0, 3.0}, {.tolerance = tolerance}, kNothing),
            IntegrationEnd::kReached);
  EXPECT_EQ(t, end);
  return x;
}

TEST(DormandPrince, AgreesWithTheOtherImplementationOfTheMethod) {
  Eigen::VectorXd start(2);
  start << 1.2, 0.3;
  const IntegrationResult other = integrate_adaptive(
      [](double t, const Eigen::VectorXd& x, Eigen::VectorXd& rate) { Pendulum()(t, x.data(), rate.data()); }, start,
      0.0, 5.0, {.absolute_tolerance = 1e-12, .relative_tolerance = 1e-12});
  const std::array<double, 2> ours = pendulum_at(5.0, 1e-12);
  EXPECT_NEAR(ours[0], other.state(0), 1e-10);
  EXPECT_NEAR(ours[1], other.state(1), 1e-10);
}

TEST(DormandPrince, ErrorFollowsTheTolerance) {
  const std::array<double, 2> exact = pendulum_at(5.0, 1e-13);
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    EXPECT_LT(std::abs(pendulum_at(5.0, tolerance)[0] - exact[0]), 50.0 * tolerance);
  }
}

TEST(DormandPrince, FixedStepsConvergeWithOrderFiveAndItsInterpolantWithOrderFour) {
  const auto errors = [](double h) {
    // x' = x cos t, x = exp(sin t): errors at the end and in the middle of steps.
    const auto f = [](double t, const double* x, double* rate) {
      rate[0] = x[0] * std::cos(t);
      return true;
    };
    DormandPrince<double> stepper(1);
    double x = 1.0, t = 0.0, between = 0.0;
    const StepControl control{.tolerance = 1e9, .first_step = h, .largest_step = h};
    (void)stepper.advance(f, t, &x, 4.0, std::array{1.0}, control, [&](double a, double b) {
      double y = 0.0;
      stepper.interpolate(0.5 * (a + b), &y);
      between = std::max(between, std::abs(y - std::exp(std::sin(0.5 * (a + b)))));
      return true;
    });
    return std::array{std::abs(x - std::exp(std::sin(4.0))), between};
  };
  const auto coarse = errors(0.1), fine = errors(0.05);
  EXPECT_NEAR(std::log2(coarse[0] / fine[0]), 5.0, 0.6);
  EXPECT_GT(std::log2(coarse[1] / fine[1]), 3.7);
}

TEST(DormandPrince, JetsCarryTheDerivativeOfTheSolution) {
  using Jet = ceres::Jet<double, 2>;
  DormandPrince<Jet> stepper(2);
  std::array<Jet, 2> x{Jet(1.2, 0), Jet(0.3, 1)};
  double t = 0.0;
  ASSERT_EQ(stepper.advance(Pendulum(), t, x.data(), 3.0, std::array{1.0, 3.0}, {.tolerance = 1e-10}, kNothing),
            IntegrationEnd::kReached);
  const auto end = [](double a, double b) {
    DormandPrince<double> other(2);
    std::array<double, 2> y{a, b};
    double time = 0.0;
    (void)other.advance(Pendulum(), time, y.data(), 3.0, std::array{1.0, 3.0}, {.tolerance = 1e-12}, kNothing);
    return y;
  };
  constexpr double h = 1e-4;
  EXPECT_NEAR(x[0].v[0], (end(1.2 + h, 0.3)[0] - end(1.2 - h, 0.3)[0]) / (2 * h), 1e-6);
  EXPECT_NEAR(x[1].v[1], (end(1.2, 0.3 + h)[1] - end(1.2, 0.3 - h)[1]) / (2 * h), 1e-6);
}

TEST(DormandPrince, EndsWithAReasonWhereTheSolutionDoes) {
  DormandPrince<double> stepper(1);
  double x = 1.0, t = 0.0;  // x' = x^2 is infinite at t = 1
  const auto square = [](double, const double* y, double* rate) {
    rate[0] = y[0] * y[0];
    return true;
  };
  const IntegrationEnd end = stepper.advance(square, t, &x, 2.0, std::array{1.0}, {.max_steps = 100000}, kNothing);
  EXPECT_NE(end, IntegrationEnd::kReached);
  EXPECT_NEAR(t, 1.0, 1e-6);
  double y = 1.0, s = 0.0;
  stepper.restart();
  const auto refuses = [](double time, const double*, double* rate) {
    rate[0] = 1.0;
    return time < 0.5;
  };
  EXPECT_EQ(stepper.advance(refuses, s, &y, 1.0, std::array{1.0}, {}, kNothing), IntegrationEnd::kNotFinite);
  EXPECT_NEAR(s, 0.5, 1e-9);
}

TEST(DormandPrince, GoesOnAfterAPauseAsIfThereHadBeenNone) {
  DormandPrince<double> stepper(2);
  std::array<double, 2> x{1.2, 0.3};
  double t = 0.0;
  for (int i = 1; i <= 50; ++i) {
    (void)stepper.advance(Pendulum(), t, x.data(), 0.1 * i, std::array{1.0, 3.0}, {.tolerance = 1e-10}, kNothing);
  }
  EXPECT_NEAR(x[0], pendulum_at(5.0, 1e-12)[0], 1e-8);
}

}  // namespace
}  // namespace veridyn::numerics
