#include "veridyn/numerics/additive_runge_kutta.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace veridyn::numerics {
namespace {

const auto kOnward = [](double, double) { return true; };

/// x' = -x y, y' = -lambda (y - 2 - x^2) - 2 x^2 y: from y = 2 + x^2 the solution stays there for every lambda, and
/// x' = -x (2 + x^2). y is stiff, and its implicit equation is linear.
struct FollowsItsParabola {
  double lambda = 1.0;
  bool operator()(double, double step, double* x, double* rate) const {
    const double square = x[0] * x[0];
    const double slope = -lambda - 2.0 * square, drive = lambda * (2.0 + square);
    if (step > 0.0) {
      const double base = x[1];
      x[1] = (base + step * drive) / (1.0 - step * slope);
      rate[1] = (x[1] - base) / step;
    } else {
      rate[1] = slope * x[1] + drive;
    }
    rate[0] = -x[0] * x[1];
    return true;
  }
  /// Bernoulli's equation: x^2 = 2/(exp(4 t) (2 + x0^2)/x0^2 - 1).
  static double exact(double t, double x0) {
    return std::sqrt(2.0 / (std::exp(4.0 * t) * (2.0 + x0 * x0) / (x0 * x0) - 1.0));
  }
};

struct Errors {
  double end = 0.0, between = 0.0;
};

Errors errors_with_step(double lambda, double h) {
  AdditiveRungeKutta stepper({0, 1});
  std::array<double, 2> x{1.0, 3.0};
  double t = 0.0;
  Errors errors;
  const StepControl control{.tolerance = 1e9, .first_step = h, .largest_step = h};
  (void)stepper.advance(FollowsItsParabola{lambda}, t, x.data(), 1.0, std::array{1.0, 1.0}, control,
                        [&](double a, double b) {
                          std::array<double, 2> y{};
                          stepper.interpolate(0.5 * (a + b), y.data());
                          const double error = y[0] - FollowsItsParabola::exact(0.5 * (a + b), 1.0);
                          errors.between = std::max(errors.between, std::abs(error));
                          return true;
                        });
  errors.end = std::abs(x[0] - FollowsItsParabola::exact(1.0, 1.0));
  return errors;
}

TEST(AdditiveRungeKutta, FixedStepsConvergeWithOrderFour) {
  const Errors coarse = errors_with_step(1.0, 0.05), fine = errors_with_step(1.0, 0.025);
  EXPECT_NEAR(std::log2(coarse.end / fine.end), 4.0, 0.3);
  EXPECT_GT(std::log2(coarse.between / fine.between), 3.5);
}

TEST(AdditiveRungeKutta, StepsOverWhatIsStiff) {
  // An explicit method needs steps below 3e-6 here.
  EXPECT_LT(errors_with_step(1e6, 0.05).end, 1e-5);
  EXPECT_LT(errors_with_step(1e3, 0.05).end, 1e-4);
}

TEST(AdditiveRungeKutta, ErrorFollowsTheTolerance) {
  for (const double lambda : {1.0, 1e2, 1e4, 1e6}) {
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
      AdditiveRungeKutta stepper({0, 1});
      std::array<double, 2> x{1.0, 3.0};
      double t = 0.0;
      ASSERT_EQ(stepper.advance(FollowsItsParabola{lambda}, t, x.data(), 1.0, std::array{1.0, 1.0},
                                {.tolerance = tolerance}, kOnward),
                IntegrationEnd::kReached);
      EXPECT_LT(std::abs(x[0] - FollowsItsParabola::exact(1.0, 1.0)), 10.0 * tolerance) << lambda;
    }
  }
}

/// With the derivative of both by the start of x: rows of one tangent each.
TEST(AdditiveRungeKutta, TangentsAreTheDerivativeOfTheSolution) {
  const double lambda = 50.0;
  const auto with_tangents = [&](double t, double step, double* x, double* rate) {
    double *S = x + 2, *S_rate = rate + 2;
    if (!FollowsItsParabola{lambda}(t, step, x, rate)) return false;
    const double slope = -lambda - 2.0 * x[0] * x[0];
    const double rest = (2.0 * lambda * x[0] - 4.0 * x[0] * x[1]) * S[0];
    S_rate[1] = (slope * S[1] + rest) / (1.0 - step * slope);
    S[1] += step * S_rate[1];
    S_rate[0] = -x[1] * S[0] - x[0] * S[1];
    return true;
  };
  AdditiveRungeKutta stepper({0, 1}, 1);
  std::array<double, 4> x{1.0, 3.0, 1.0, 2.0};  // dy/dx0 = 2 x0
  double t = 0.0;
  ASSERT_EQ(stepper.advance(with_tangents, t, x.data(), 1.0, std::array{1.0, 1.0},
                            {.tolerance = 1e-9, .derivative_tolerance = 1e-9}, kOnward),
            IntegrationEnd::kReached);
  constexpr double h = 1e-5;
  EXPECT_NEAR(x[2], (FollowsItsParabola::exact(1.0, 1.0 + h) - FollowsItsParabola::exact(1.0, 1.0 - h)) / (2.0 * h),
              1e-7);
}

TEST(AdditiveRungeKutta, EndsWithAReasonWhereTheSolutionDoes) {
  AdditiveRungeKutta stepper({0});
  double x = 1.0, t = 0.0;  // x' = x^2 is infinite at t = 1
  const auto square = [](double, double, const double* y, double* rate) {
    rate[0] = y[0] * y[0];
    return true;
  };
  EXPECT_NE(stepper.advance(square, t, &x, 2.0, std::array{1.0}, {.max_steps = 100000}, kOnward),
            IntegrationEnd::kReached);
  EXPECT_NEAR(t, 1.0, 1e-6);
  AdditiveRungeKutta other({0});
  double y = 1.0, s = 0.0;
  const auto refuses = [](double time, double, const double*, double* rate) {
    rate[0] = 1.0;
    return time < 0.5;
  };
  EXPECT_EQ(other.advance(refuses, s, &y, 1.0, std::array{1.0}, {}, kOnward), IntegrationEnd::kNotFinite);
  EXPECT_NEAR(s, 0.5, 1e-9);
}

TEST(AdditiveRungeKutta, TheCallerCanStopItAndGoOn) {
  AdditiveRungeKutta stepper({0, 1});
  std::array<double, 2> x{1.0, 3.0};
  double t = 0.0;
  (void)stepper.advance(FollowsItsParabola{10.0}, t, x.data(), 1.0, std::array{1.0, 1.0}, {.tolerance = 1e-8},
                        [](double, double to) { return to < 0.5; });
  EXPECT_GE(t, 0.5);
  EXPECT_LT(t, 1.0);
  (void)stepper.advance(FollowsItsParabola{10.0}, t, x.data(), 1.0, std::array{1.0, 1.0}, {.tolerance = 1e-8}, kOnward);
  EXPECT_EQ(t, 1.0);
  EXPECT_NEAR(x[0], FollowsItsParabola::exact(1.0, 1.0), 1e-6);
}

}  // namespace
}  // namespace veridyn::numerics
