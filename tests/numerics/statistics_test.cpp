#include "veridyn/numerics/statistics.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "veridyn/core/error.hpp"

namespace {
using namespace veridyn::numerics;

std::vector<double> ar1(unsigned seed, std::size_t count, double rho) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x(count);
  double state = normal(generator);
  for (double& v : x) {
    state = rho * state + std::sqrt(1.0 - rho * rho) * normal(generator);
    v = state;
  }
  return x;
}

// Abramowitz & Stegun, tables 26.1, 26.8, 26.10.
TEST(Quantiles, MatchPublishedTables) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(normal_cdf(1.0), 0.841344746068543, 1e-14);
  EXPECT_NEAR(student_t_quantile(0.975, 10.0), 2.228138851986, 1e-9);
  EXPECT_NEAR(student_t_quantile(0.975, 1.0), 12.7062047364, 1e-8);
  EXPECT_NEAR(student_t_two_sided_p(2.228138851986, 10.0), 0.05, 1e-10);
  EXPECT_NEAR(chi_square_quantile(0.95, 6.0), 12.591587243744, 1e-9);
  EXPECT_NEAR(chi_square_quantile(0.95, 2.0), -2.0 * std::log(0.05), 1e-12);  // closed form for 2 degrees of freedom
  EXPECT_NEAR(chi_square_upper_p(3.0, 2.0), std::exp(-1.5), 1e-14);
}

TEST(NormalProbabilityPlot, IsAStraightLineForNormalDataAndNotForUniformData) {
  const std::vector<double> x = ar1(1, 5001, 0.0);  // odd: the middle sample is among the 101
  const NormalPlot plot = normal_probability_plot(x, 101);
  ASSERT_EQ(plot.quantile.size(), 101U);
  EXPECT_NEAR(plot.quantile[50], 0.0, 1e-12);
  EXPECT_NEAR(plot.quantile.front(), -plot.quantile.back(), 1e-12);
  EXPECT_GT(plot.correlation, 0.998);
  EXPECT_NEAR(plot.sd, 1.0, 0.03);
  std::vector<double> uniform;
  for (int k = 0; k < 5000; ++k) uniform.push_back(k);
  EXPECT_LT(normal_probability_plot(uniform, 101).correlation, 0.985);
}

TEST(Autocorrelation, FollowsThePowersOfAnAr1ProcessAndSegments) {
  const std::vector<double> x = ar1(2, 200000, 0.8);
  const Autocorrelation r = autocorrelation(x, 5);
  for (std::size_t k = 0; k <= 5; ++k) EXPECT_NEAR(r.value[k], std::pow(0.8, static_cast<double>(k)), 0.01);
  // Two segments whose only link would be the product across the border: 1, -1 | -1, 1 has lag-1 products -1, -1
  // inside.
  const std::vector<double> y = {1.0, -1.0, -1.0, 1.0};
  const std::vector<int> segment = {0, 0, 1, 1};
  EXPECT_DOUBLE_EQ(autocorrelation(y, 1, segment).value[1], -0.5);
  EXPECT_DOUBLE_EQ(autocorrelation(y, 1).value[1], -0.25);
}

TEST(WhitenessTest, RejectsWhiteNoiseAsOftenAsItPromises) {
  int rejected = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) rejected += whiteness_test(ar1(seed, 1000, 0.0)).white() ? 0 : 1;
  EXPECT_NEAR(rejected / 400.0, 0.05, 0.03);
  const WhitenessTest coloured = whiteness_test(ar1(3, 1000, 0.5));
  EXPECT_FALSE(coloured.white());
  EXPECT_NEAR(coloured.durbin_watson, 2.0 * (1.0 - 0.5), 0.15);
}

TEST(EffectiveSampleSize, MatchesTheSpreadOfVariances) {
  const double rho = 0.8;
  const std::size_t n = 2000;
  double variance_power = 0.0, size_variance = 0.0;
  const int runs = 400;
  for (int m = 0; m < runs; ++m) {
    const std::vector<double> x = ar1(static_cast<unsigned>(m + 10), n, rho);
    double power = 0.0;
    for (const double v : x) power += v * v / static_cast<double>(n);
    variance_power += (power - 1.0) * (power - 1.0) / runs;
    size_variance += effective_sample_size_variance(x) / runs;
  }
  EXPECT_NEAR(size_variance * variance_power / 2.0, 1.0, 0.2);  // Var(s^2) = 2/N_eff
}

TEST(FitMeasures, MatchHandComputedNumbers) {
  const std::vector<double> measured = {1.0, 2.0, 3.0, 4.0, std::numeric_limits<double>::quiet_NaN()};
  const std::vector<double> model = {1.5, 2.0, 2.0, 4.5, 9.0};
  const FitMeasures fit = fit_measures(measured, model);
  EXPECT_EQ(fit.count, 4U);
  EXPECT_DOUBLE_EQ(fit.mae, 0.5);
  EXPECT_DOUBLE_EQ(fit.bias, 0.0);
  EXPECT_DOUBLE_EQ(fit.rmse, std::sqrt(1.5 / 4.0));
  EXPECT_DOUBLE_EQ(fit.r2, 1.0 - 1.5 / 5.0);
  EXPECT_DOUBLE_EQ(fit.theil, std::sqrt(1.5 / 4.0) / (std::sqrt(30.0 / 4.0) + std::sqrt(30.5 / 4.0)));
  EXPECT_DOUBLE_EQ(fit_measures(std::vector<double>{1.0, -2.0}, std::vector<double>{-1.0, 2.0}).theil, 1.0);
  EXPECT_THROW((void)fit_measures(measured, std::vector<double>{1.0}), veridyn::InputError);
}

TEST(QuantileOfSorted, LiesOnLinesBetweenNeighbours) {
  const std::vector<double> sorted = {1.0, 2.0, 4.0, 8.0, 16.0};
  EXPECT_EQ(quantile_of_sorted(sorted, 0.0), 1.0);
  EXPECT_EQ(quantile_of_sorted(sorted, 0.5), 4.0);
  EXPECT_EQ(quantile_of_sorted(sorted, 0.625), 6.0);
  EXPECT_EQ(quantile_of_sorted(sorted, 1.0), 16.0);
  EXPECT_EQ(quantile_of_sorted(std::vector<double>{3.0}, 0.3), 3.0);
}

TEST(RobustSd, IgnoresAMinorityOfOutliers) {
  std::vector<double> x = ar1(5, 10000, 0.0);
  for (std::size_t k = 0; k < x.size(); k += 10) x[k] = 1e6;
  EXPECT_NEAR(robust_sd(x), 1.0, 0.2);
  EXPECT_DOUBLE_EQ(median(std::vector<double>{4.0, 1.0, 2.0, 3.0}), 2.5);
}

}  // namespace
