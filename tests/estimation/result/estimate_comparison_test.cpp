#include "veridyn/estimation/result/estimate_comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/refusal.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {
namespace {

using ::testing::HasSubstr;

NamedEstimate named(std::string name, const Eigen::VectorXd& value, const Eigen::MatrixXd& covariance) {
  NamedEstimate e{.name = std::move(name)};
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    Parameter p{.name = "p" + std::to_string(i), .value = value(i), .sigma = std::sqrt(covariance(i, i))};
    p.status = ParameterStatus::kIdentified;
    p.low95 = p.value - 1.96 * p.sigma;
    p.high95 = p.value + 1.96 * p.sigma;
    e.estimate.parameters.push_back(p);
  }
  e.estimate.covariance = covariance;
  return e;
}

// Values 1, 2 and 4 with sigma 1: mean 7/3, Q = (16 + 1 + 25)/9 = 14/3.
TEST(EstimateComparison, HasMeanAndScatterOfAParameter) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
  std::vector<NamedEstimate> estimates;
  for (const double v : {1.0, 2.0, 4.0})
    estimates.push_back(named("e" + std::to_string(v), Eigen::VectorXd::Constant(1, v), one));
  const EstimateComparison c = compare_estimates(estimates);
  ASSERT_EQ(c.parameters.size(), 1U);
  EXPECT_NEAR(c.parameters[0].mean, 7.0 / 3.0, 1e-12);
  EXPECT_NEAR(c.parameters[0].sigma, 1.0 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(c.parameters[0].q, 14.0 / 3.0, 1e-12);
  EXPECT_NEAR(c.parameters[0].p, numerics::chi_square_upper_p(14.0 / 3.0, 2.0), 1e-12);
  // (Q - 2)/(3 - 3/3)
  EXPECT_NEAR(c.parameters[0].between_sigma, std::sqrt((14.0 / 3.0 - 2.0) / 2.0), 1e-12);
  EXPECT_EQ(c.pairs.size(), 3U);
}

// d = (1, -1), sum of covariances [2 1; 1 2]: d' P^-1 d = 2 where it would be 1 without the correlation.
TEST(EstimateComparison, TakesTheWholeCovariance) {
  Eigen::MatrixXd P(2, 2);
  P << 1.0, 0.5, 0.5, 1.0;
  const std::vector<NamedEstimate> estimates{named("a", Eigen::Vector2d(1.0, 0.0), P),
                                             named("b", Eigen::Vector2d(0.0, 1.0), P)};
  EXPECT_NEAR(compare_estimates(estimates).pairs.at(0).chi_square, 2.0, 1e-12);
}

// At 5 % one pair in twenty of a thousand made ones differs: 50 +- 7.
TEST(EstimateComparison, DiffersByChanceAsOftenAsItSays) {
  Eigen::MatrixXd P(3, 3);
  P << 1.0, 0.8, 0.1, 0.8, 2.0, 0.3, 0.1, 0.3, 0.5;
  const Eigen::MatrixXd L = P.llt().matrixL();
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  const auto draw = [&] {
    return Eigen::VectorXd(L * Eigen::Vector3d(normal(generator), normal(generator), normal(generator)));
  };
  int differing = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::vector<NamedEstimate> estimates{named("a", draw(), P), named("b", draw(), P)};
    differing += compare_estimates(estimates).pairs.at(0).p < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(differing, 50, 21);
}

// A third parameter that is the ratio of the first two, with the covariance of its linear terms: it curves, and adds
// nothing.
TEST(EstimateComparison, TakesNoFunctionOfOthersForAContradiction) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  const auto draw = [&] {
    const Eigen::Vector2d x(10.0 + 0.3 * normal(generator), 5.0 + 0.1 * normal(generator));
    Eigen::MatrixXd J(3, 2);
    J << 1.0, 0.0, 0.0, 1.0, 1.0 / x(1), -x(0) / (x(1) * x(1));
    const Eigen::Vector2d variance(0.09, 0.01);
    return std::pair<Eigen::VectorXd, Eigen::MatrixXd>(Eigen::Vector3d(x(0), x(1), x(0) / x(1)),
                                                       J * variance.asDiagonal() * J.transpose());
  };
  int differing = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto [a, P] = draw();
    const auto [b, Q] = draw();
    const std::vector<NamedEstimate> estimates{named("a", a, P), named("b", b, Q)};
    differing += compare_estimates(estimates).pairs.at(0).p < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(differing, 50, 21);
}

TEST(EstimateComparison, SaysWhatContradictsAndWhatCannotBeCompared) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(2, 2);
  std::vector<NamedEstimate> estimates{named("a", Eigen::Vector2d(0.0, 0.0), one),
                                       named("b", Eigen::Vector2d(9.0, 0.0), one)};
  estimates[1].estimate.parameters[1].status = ParameterStatus::kRejected;
  const EstimateComparison c = compare_estimates(estimates);
  EXPECT_EQ(c.pairs.at(0).largest, "p0");
  EXPECT_EQ(c.evidence.at(0).outcome, Outcome::kFailed);
  EXPECT_THAT(c.text, HasSubstr("not of one value: p0"));
  EXPECT_THAT(c.notes, ::testing::ElementsAre(HasSubstr("p1: one estimate")));
  estimates[1].estimate.parameters[0].unit = "rad";
  EXPECT_THAT(why([&] { static_cast<void>(compare_estimates(estimates)); }), HasSubstr("has p0 in rad"));
  EXPECT_THAT(why([&] { static_cast<void>(compare_estimates(std::span(estimates).first(1))); }),
              HasSubstr("at least two"));
}

}  // namespace
}  // namespace veridyn::estimation
