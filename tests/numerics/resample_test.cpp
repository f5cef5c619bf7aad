#include "veridyn/numerics/resample.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace {
using namespace veridyn::numerics;
using veridyn::kPi;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double worst_sine_error(double step, Interpolation method) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  std::vector<double> t, x;
  for (int k = 0; k * step < 2.0; ++k) {
    t.push_back((k + jitter(generator)) * step);
    x.push_back(std::sin(2.0 * kPi * t.back()));
  }
  const UniformGrid grid = UniformGrid::covering(0.1, 1.9, step / 3.0);
  const std::vector<double> y = resample(t, x, grid, {.interpolation = method});
  double worst = 0.0;
  for (std::size_t k = 0; k < grid.count; ++k)
    worst = std::max(worst, std::abs(y[k] - std::sin(2.0 * kPi * grid.at(k))));
  return worst;
}

TEST(Resample, ConvergesWithTheOrderOfTheInterpolation) {
  // Linear: second order. Monotone cubic: second order too at extrema, where it flattens, with a smaller constant.
  EXPECT_NEAR(worst_sine_error(0.02, Interpolation::kLinear) / worst_sine_error(0.01, Interpolation::kLinear), 4.0,
              1.2);
  EXPECT_GT(worst_sine_error(0.02, Interpolation::kPchip) / worst_sine_error(0.01, Interpolation::kPchip), 3.0);
  EXPECT_LT(worst_sine_error(0.02, Interpolation::kPchip), 0.7 * worst_sine_error(0.02, Interpolation::kLinear));
}

TEST(Resample, NeverOvershootsNorExtrapolatesNorFillsGaps) {
  const std::vector<double> t = {0.0, 0.1, 0.2, 0.3, 2.0, 2.1, 2.2}, x = {0.0, 0.0, 1.0, 1.0, 5.0, 5.0, 6.0};
  const UniformGrid grid{-0.5, 0.05, 80};
  const std::vector<double> y = resample(t, x, grid);
  for (std::size_t k = 0; k < grid.count; ++k) {
    const double at = grid.at(k);
    const bool inside = (at > -1e-6 && at < 0.3 + 1e-6) || (at > 2.0 - 1e-6 && at < 2.2 + 1e-6);
    EXPECT_EQ(std::isfinite(y[k]), inside) << at;
    if (inside && at < 1.0) {
      EXPECT_TRUE(y[k] >= 0.0 && y[k] <= 1.0) << at;
    }
  }
}

TEST(Resample, AveragesDoubledStampsAndSkipsNans) {
  const std::vector<double> t = {0.0, 1.0, 1.0, 1.0, 2.0, 3.0, 4.0}, x = {0.0, 0.0, 1.0, 2.0, kNan, 3.0, 4.0};
  const std::vector<double> y =
      resample(t, x, {0.0, 1.0, 5}, {.interpolation = Interpolation::kLinear, .gap_limit_s = 5.0});
  EXPECT_EQ(y, (std::vector<double>{0.0, 1.0, 2.0, 3.0, 4.0}));
  const std::vector<double> held =
      resample(t, x, {0.0, 0.5, 3}, {.interpolation = Interpolation::kHold, .gap_limit_s = 5.0});
  EXPECT_EQ(held, (std::vector<double>{0.0, 0.0, 2.0}));
  EXPECT_THROW((void)resample(std::vector<double>{1.0, 0.0}, std::vector<double>{0.0, 0.0}, {0.0, 1.0, 2}),
               veridyn::InputError);
}

// 9 Hz sampled at 100 Hz, thinned to 10 Hz, would come back as 1 Hz.
TEST(Resample, RemovesWhatTheCoarserGridCannotHold) {
  std::vector<double> t, x;
  for (int k = 0; k < 4000; ++k) {
    t.push_back(0.01 * k);
    x.push_back(std::sin(2.0 * kPi * 9.0 * t.back()) + std::sin(2.0 * kPi * 0.5 * t.back()));
  }
  const UniformGrid grid{2.0, 0.1, 350};
  const std::vector<double> y = resample(t, x, grid);
  const std::vector<double> aliased = resample(t, x, grid, {.anti_alias = false});
  double worst = 0.0, worst_aliased = 0.0;
  for (std::size_t k = 0; k < grid.count; ++k) {
    const double slow = std::sin(2.0 * kPi * 0.5 * grid.at(k));
    worst = std::max(worst, std::abs(y[k] - slow));
    worst_aliased = std::max(worst_aliased, std::abs(aliased[k] - slow));
  }
  EXPECT_LT(worst, 5e-3);
  EXPECT_GT(worst_aliased, 0.9);
}

TEST(UnwrapAngles, RemovesTurns) {
  std::vector<double> angle = {3.0, -3.0, kNan, -2.8, 3.1};
  unwrap_angles(angle);
  EXPECT_NEAR(angle[1], 2.0 * kPi - 3.0, 1e-15);
  EXPECT_NEAR(angle[3], 2.0 * kPi - 2.8, 1e-15);
  EXPECT_NEAR(angle[4], 3.1, 1e-15);
}

}  // namespace
