#include "veridyn/muscle/identification/emg_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::muscle {
namespace {

ControlSignals ramp() {
  std::vector<double> time, values;
  for (int k = 0; k <= 300; ++k) {
    time.push_back(0.01 * k);
    values.push_back(0.02 + 0.001 * k);
  }
  return {time, values, 1, Interpolation::kLinear};
}

double value_at(const ControlSignals& signal, double time) {
  double value = 0.0;
  signal.evaluate(time, &value);
  return value;
}

TEST(EmgError, TheSquaresOfAPartsShapesAddUpToOne) {
  const EmgError error{};
  const std::vector<EmgErrorShape> shapes = error_shapes(error, 0.3, 2.7);
  for (const double t : {0.3, 1.234, 2.7}) {
    std::vector<double> sum(kEmgErrorParts, 0.0);
    for (const EmgErrorShape& s : shapes)
      if (std::abs(t - s.knot) < s.spacing) sum[s.part] += std::pow(std::cos(0.5 * kPi * (t - s.knot) / s.spacing), 2);
    for (const double of_part : sum) EXPECT_NEAR(of_part, 1.0, 1e-12) << t;
  }
  EXPECT_DOUBLE_EQ(shapes.front().spacing, error.spacing());
  EXPECT_DOUBLE_EQ(shapes.back().spacing, error.slow_s);
  EXPECT_TRUE(error_shapes({.relative = 0.0}, 0.0, 1.0).empty());
}

TEST(EmgError, ChangesAnEnvelopeByItsSize) {
  const std::vector<EmgErrorShape> one{{1.0, 0.5, 0}};
  const Eigen::VectorXd two = Eigen::VectorXd::Constant(1, 2.0);
  const double recorded = value_at(ramp(), 1.0);
  EXPECT_NEAR(value_at(without_errors(ramp(), {.relative = 0.1}, one, two), 1.0), recorded * std::exp(0.2), 1e-12);
  EXPECT_NEAR(value_at(without_errors(ramp(), {.relative = 0.0, .absolute = 0.05}, one, two), 1.0), recorded + 0.1,
              1e-12);
  // Nothing where the shape ends.
  EXPECT_NEAR(value_at(without_errors(ramp(), {.relative = 0.1}, one, two), 1.6), value_at(ramp(), 1.6), 1e-12);
}

// de/dx = hypot(relative e, absolute), by central differences.
TEST(EmgError, GrowsAsItsStandardDeviationSays) {
  const EmgError error{.relative = 0.2, .absolute = 0.03};
  const std::vector<EmgErrorShape> one{{1.0, 0.5, 0}};
  const auto e = [&](double x) {
    return value_at(without_errors(ramp(), error, one, Eigen::VectorXd::Constant(1, x)), 1.0);
  };
  for (const double x : {-1.0, 0.0, 1.5})
    EXPECT_NEAR((e(x + 1e-4) - e(x - 1e-4)) / 2e-4, std::hypot(0.2 * e(x), 0.03), 1e-8) << x;
}

TEST(EmgError, NeverLeavesANegativeExcitation) {
  const EmgError error{.relative = 0.1, .absolute = 0.1};
  const std::vector<EmgErrorShape> shapes = error_shapes(error, 0.0, 3.0);
  const ControlSignals e =
      without_errors(ramp(), error, shapes, Eigen::VectorXd::Constant(signed_index(shapes.size()), -5.0));
  for (std::size_t k = 0; k < e.times().size(); ++k) EXPECT_GE(e.row(k)[0], 0.0);
}

}  // namespace
}  // namespace veridyn::muscle
