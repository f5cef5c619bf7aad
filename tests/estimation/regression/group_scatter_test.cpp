#include "veridyn/estimation/regression/group_scatter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

/// One parameter (or more, independent of each other) with its standard errors.
RegressionEstimate estimate_of(const std::vector<double>& values, const std::vector<double>& sigmas) {
  RegressionEstimate e;
  e.termination = EstimateTermination::kEstimated;
  const auto n = static_cast<Eigen::Index>(values.size());
  e.theta.resize(n);
  e.covariance = Eigen::MatrixXd::Zero(n, n);
  e.degrees_of_freedom = 100.0;
  for (Eigen::Index j = 0; j < n; ++j) {
    e.theta(j) = values[j];
    e.covariance(j, j) = sigmas[j] * sigmas[j];
    e.parameters.push_back({.name = "p" + std::to_string(j), .value = values[j], .sigma = sigmas[j]});
  }
  return e;
}

// By hand: values 1, 2, 4 with standard errors 0.1: mean 7/3, Q = (16/9 + 1/9 + 25/9)/0.01 = 466.7; tau^2 = (Q - 2)/200
// = 2.3233; equal weights, so the standard error is that of a mean of three, sqrt(14/3/(2 3)).
TEST(GroupScatter, IsThatOfAMeanOfThree) {
  const std::vector<RegressionEstimate> groups{estimate_of({1.0}, {0.1}), estimate_of({2.0}, {0.1}),
                                               estimate_of({4.0}, {0.1})};
  const GroupScatter scatter = group_scatter(groups);
  EXPECT_EQ(scatter.compared, 3u);
  EXPECT_NEAR(scatter.q, 1400.0 / 3.0, 1e-9);
  EXPECT_EQ(scatter.freedom, 2.0);
  EXPECT_TRUE(scatter.found());
  EXPECT_NEAR(scatter.mean(0), 7.0 / 3.0, 1e-12);
  EXPECT_NEAR(scatter.sigma(0), std::sqrt(14.0 / 18.0), 1e-12);
  EXPECT_NEAR(scatter.between_sigma(0), std::sqrt((1400.0 / 3.0 - 2.0) / 200.0), 1e-12);
  RegressionEstimate all = estimate_of({2.0}, {0.05});
  take_mean(all, scatter, 0.05);
  EXPECT_DOUBLE_EQ(all.parameters[0].value, scatter.mean(0));
  // Student's t of 2 degrees of freedom: 4.302653 (tables).
  EXPECT_NEAR(all.parameters[0].high95 - all.parameters[0].value, 4.302653 * scatter.sigma(0), 1e-6);
  EXPECT_NEAR(all.covariance(0, 0), scatter.sigma(0) * scatter.sigma(0), 1e-12);
  EXPECT_EQ(all.parameters[0].status, ParameterStatus::kInsignificant) << "t = 2.6 on 2 degrees of freedom";
}

TEST(GroupScatter, DoesNotDependOnUnits) {
  const std::vector<RegressionEstimate> groups{estimate_of({1.0, 3.0e6}, {0.1, 2.0e5}),
                                               estimate_of({1.1, 3.3e6}, {0.1, 2.0e5}),
                                               estimate_of({1.3, 2.9e6}, {0.1, 2.0e5})};
  const std::vector<RegressionEstimate> scaled{estimate_of({1.0e-6, 3.0}, {0.1e-6, 0.2}),
                                               estimate_of({1.1e-6, 3.3}, {0.1e-6, 0.2}),
                                               estimate_of({1.3e-6, 2.9}, {0.1e-6, 0.2})};
  EXPECT_NEAR(group_scatter(groups).q, group_scatter(scaled).q, 1e-9);
  EXPECT_NEAR(group_scatter(groups).sigma(1), 1e6 * group_scatter(scaled).sigma(1), 1e-3);
}

TEST(GroupScatter, ComparesOnlyGroupsThatDetermineTheParameters) {
  RegressionEstimate unexcited = estimate_of({50.0}, {0.1});
  unexcited.unexcited.push_back({});
  std::vector<RegressionEstimate> groups{estimate_of({1.0}, {0.1}), unexcited, RegressionEstimate{}};
  const GroupScatter one = group_scatter(groups);
  EXPECT_EQ(one.groups, 3u);
  EXPECT_EQ(one.compared, 1u);
  EXPECT_FALSE(one.found());
  groups.push_back(estimate_of({1.05}, {0.1}));
  const GroupScatter two = group_scatter(groups);
  EXPECT_EQ(two.compared, 2u);
  EXPECT_FALSE(two.found()) << "0.35 standard errors apart";
}

/// Share of 4000 sets of groups whose interval of the mean holds it; groups have unlike standard errors.
double share_held(std::size_t groups, double scatter_sd) {
  numerics::RandomStream random(7, "sets of groups");
  constexpr int kSets = 4000;
  int held = 0;
  for (int set = 0; set < kSets; ++set) {
    std::vector<RegressionEstimate> estimates;
    for (std::size_t g = 0; g < groups; ++g) {
      const double sigma = random.uniform(0.7, 1.4);
      estimates.push_back(estimate_of({5.0 + scatter_sd * random.normal() + sigma * random.normal()}, {sigma}));
    }
    RegressionEstimate mean = estimate_of({0.0}, {1.0});
    take_mean(mean, group_scatter(estimates), 0.05);
    held += mean.parameters[0].low95 <= 5.0 && 5.0 <= mean.parameters[0].high95 ? 1 : 0;
  }
  return static_cast<double>(held) / kSets;
}

// 4000 sets: a standard deviation of 0.35 % about 95 %. Normal intervals with the scatter of DerSimonian and Laird
// would hold the mean of four groups in some 88 %.
TEST(GroupScatter, IntervalsHoldTheMeanWithScatterAndWithout) {
  for (const std::size_t groups : {3u, 4u, 8u}) {
    for (const double scatter_sd : {0.0, 1.0, 5.0})
      EXPECT_NEAR(share_held(groups, scatter_sd), 0.95, 0.013) << groups << " groups, scatter " << scatter_sd;
  }
}

}  // namespace
}  // namespace veridyn::estimation
