#include "veridyn/numerics/sensitivity_indices.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

template <typename Function>
Eigen::VectorXd at_points(const Eigen::MatrixXd& design, const Function& f) {
  Eigen::VectorXd y(design.rows());
  for (Eigen::Index i = 0; i < y.size(); ++i) y(i) = f(design.row(i));
  return y;
}

/// sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, inputs in -pi..pi (Ishigami & Homma 1990).
double ishigami(const Eigen::RowVectorXd& u) {
  const Eigen::RowVectorXd x = (2.0 * u.array() - 1.0) * kPi;
  return std::sin(x(0)) + 7.0 * std::pow(std::sin(x(1)), 2) + 0.1 * std::pow(x(2), 4) * std::sin(x(0));
}

struct ClosedForm {
  std::vector<double> first, total;
};
ClosedForm ishigami_indices() {
  const double a = 7.0, b = 0.1;
  const double V1 = 0.5 * std::pow(1.0 + b * std::pow(kPi, 4) / 5.0, 2), V2 = a * a / 8.0;
  const double V13 = b * b * std::pow(kPi, 8) * 8.0 / 225.0, V = V1 + V2 + V13;
  return {{V1 / V, V2 / V, 0.0}, {(V1 + V13) / V, V2 / V, V13 / V}};
}

TEST(VarianceIndices, OfIshigamiAreThoseOfTheClosedForm) {
  const SensitivityOptions options{.samples = 8192};
  const SensitivityIndices found = variance_indices(at_points(variance_design(3, options), ishigami), 3, options);
  const ClosedForm exact = ishigami_indices();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.inputs[i].first, exact.first[i], 0.01);
    EXPECT_NEAR(found.inputs[i].total, exact.total[i], 0.01);
    EXPECT_LT(found.inputs[i].first_low, found.inputs[i].first_high);
  }
  EXPECT_EQ(found.evaluations, 5u * 8192u);
  EXPECT_NEAR(found.mean, 3.5, 0.01);
}

/// prod (|4 x_i - 2| + a_i)/(1 + a_i): V_i = 1/(3 (1 + a_i)^2), V = prod (1 + V_i) - 1 (Saltelli et al. 2010).
constexpr double kSobolG[6] = {0.0, 0.5, 3.0, 9.0, 99.0, 99.0};

double sobol_g(const Eigen::RowVectorXd& x) {
  double product = 1.0;
  for (int i = 0; i < 6; ++i) product *= (std::abs(4.0 * x(i) - 2.0) + kSobolG[i]) / (1.0 + kSobolG[i]);
  return product;
}

ClosedForm sobol_g_indices() {
  double all = 1.0;
  for (const double a : kSobolG) all *= 1.0 + 1.0 / (3.0 * (1.0 + a) * (1.0 + a));
  ClosedForm exact;
  for (const double a : kSobolG) {
    const double V = 1.0 / (3.0 * (1.0 + a) * (1.0 + a));
    exact.first.push_back(V / (all - 1.0));
    exact.total.push_back(V * all / (1.0 + V) / (all - 1.0));
  }
  return exact;
}

TEST(VarianceIndices, OfSobolsGAreThoseOfTheClosedForm) {
  const SensitivityOptions options{.samples = 8192};
  const SensitivityIndices found = variance_indices(at_points(variance_design(6, options), sobol_g), 6, options);
  const ClosedForm exact = sobol_g_indices();
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(found.inputs[i].first, exact.first[i], 0.01);
    EXPECT_NEAR(found.inputs[i].total, exact.total[i], 0.01);
  }
}

/// Shares of the indices of 200 seeds that their 95 % intervals cover, and the intervals' mean widths.
struct Coverage {
  double first = 0.0, total = 0.0, first_width = 0.0, total_width = 0.0;
};

template <typename Function>
Coverage coverage_of(const Function& f, const ClosedForm& exact, std::size_t samples) {
  constexpr std::uint64_t kSeeds = 200;
  Coverage c;
  const std::size_t inputs = exact.first.size();
  const double one = 1.0 / static_cast<double>(kSeeds * inputs);
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SensitivityOptions options{.samples = samples, .seed = seed};
    const SensitivityIndices found = variance_indices(at_points(variance_design(inputs, options), f), inputs, options);
    for (std::size_t i = 0; i < inputs; ++i) {
      const SensitivityIndex& s = found.inputs[i];
      c.first += s.first_low <= exact.first[i] && exact.first[i] <= s.first_high ? one : 0.0;
      c.total += s.total_low <= exact.total[i] && exact.total[i] <= s.total_high ? one : 0.0;
      c.first_width += one * (s.first_high - s.first_low);
      c.total_width += one * (s.total_high - s.total_low);
    }
  }
  ::testing::Test::RecordProperty("coverage of first orders", std::to_string(c.first));
  ::testing::Test::RecordProperty("coverage of total orders", std::to_string(c.total));
  ::testing::Test::RecordProperty("mean width of first orders", std::to_string(c.first_width));
  ::testing::Test::RecordProperty("mean width of total orders", std::to_string(c.total_width));
  return c;
}

// Chance: 600 and 1200 intervals of 95 % are covered within 2 %; what is left is that replicates are few and not
// normal.
TEST(VarianceIndices, IntervalsCoverIshigamisClosedForm) {
  const Coverage c = coverage_of(ishigami, ishigami_indices(), 512);
  EXPECT_GE(c.first, 0.90);
  EXPECT_LE(c.first, 0.98);
  EXPECT_GE(c.total, 0.90);
  EXPECT_LE(c.total, 0.98);
}

TEST(VarianceIndices, IntervalsCoverSobolsGsClosedForm) {
  const Coverage c = coverage_of(sobol_g, sobol_g_indices(), 512);
  EXPECT_GE(c.first, 0.90);
  EXPECT_LE(c.first, 0.98);
  EXPECT_GE(c.total, 0.90);
  EXPECT_LE(c.total, 0.98);
}

TEST(VarianceIndices, AreThoseOfAnyNumberOfReplicatesAndSamples) {
  const ClosedForm exact = ishigami_indices();
  for (const std::size_t replicates : {std::size_t{2}, std::size_t{7}, std::size_t{100}}) {
    const SensitivityOptions options{.samples = 3000, .replicates = replicates};
    const SensitivityIndices found = variance_indices(at_points(variance_design(3, options), ishigami), 3, options);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(found.inputs[i].first, exact.first[i], 0.05) << replicates;
      EXPECT_NEAR(found.inputs[i].total, exact.total[i], 0.05) << replicates;
    }
  }
  EXPECT_EQ((SensitivityOptions{.samples = 5}.used_replicates()), 2u);
  EXPECT_EQ((SensitivityOptions{.samples = 40}.used_replicates()), 10u);
  EXPECT_EQ((SensitivityOptions{.samples = 4096}.used_replicates()), 16u);
  EXPECT_THROW((SensitivityOptions{.replicates = 1}.validate()), InputError);
}

TEST(VarianceIndices, RowsWithoutAResultAreLeftOutAndCounted) {
  const SensitivityOptions options{.samples = 4096};
  Eigen::VectorXd y = at_points(variance_design(3, options), ishigami);
  for (Eigen::Index i = 0; i < 40; ++i) y(100 * i + 7) = std::numeric_limits<double>::quiet_NaN();
  const SensitivityIndices found = variance_indices(y, 3, options);
  EXPECT_EQ(found.dropped, 40u);
  EXPECT_NEAR(found.inputs[1].first, ishigami_indices().first[1], 0.02);
  EXPECT_THROW((void)variance_indices(y.head(10), 3, options), InputError);
  y.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW((void)variance_indices(y, 3, options), InputError);
  EXPECT_THROW((SensitivityOptions{.samples = 1}.validate()), InputError);
}

TEST(SobolPoints, FillEveryIntervalOfEachDimensionAlike) {
  // The first 2^m points have one in each interval of length 2^-m, shifted or not.
  const Eigen::MatrixXd x = sobol_points(256, 24, 5);
  for (Eigen::Index j = 0; j < x.cols(); ++j) {
    std::vector<int> count(256, 0);
    for (Eigen::Index i = 0; i < x.rows(); ++i) ++count[static_cast<std::size_t>(x(i, j) * 256.0)];
    for (const int c : count) EXPECT_EQ(c, 1) << j;
  }
  EXPECT_EQ(x, sobol_points(256, 24, 5));
  EXPECT_NE(x, sobol_points(256, 24, 6));
  EXPECT_THROW((void)sobol_points(4, 1001, 1), InputError);
}

TEST(MorrisEffects, OfALinearFunctionAreItsCoefficients) {
  const Eigen::MatrixXd design = morris_design(4, 20, 6, 3);
  EXPECT_GE(design.minCoeff(), 0.0);
  EXPECT_LE(design.maxCoeff(), 1.0);
  const auto linear = [](const Eigen::RowVectorXd& x) { return 3.0 * x(0) - 2.0 * x(1) + 0.5 * x(3) + 4.0; };
  const std::vector<MorrisEffect> effects = morris_effects(design, at_points(design, linear));
  const double expected[4] = {3.0, -2.0, 0.0, 0.5};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(effects[i].mean, expected[i], 1e-12);
    EXPECT_NEAR(effects[i].absolute, std::abs(expected[i]), 1e-12);
    EXPECT_NEAR(effects[i].sd, 0.0, 1e-12);
  }
  // x0 x1: the effect of each is the other, so it varies.
  const auto product = [](const Eigen::RowVectorXd& x) { return x(0) * x(1); };
  EXPECT_GT(morris_effects(design, at_points(design, product))[0].sd, 0.2);
  EXPECT_THROW((void)morris_design(3, 4, 5, 1), InputError);
}

}  // namespace
}  // namespace veridyn::numerics
