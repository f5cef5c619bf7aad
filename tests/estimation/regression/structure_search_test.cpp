#include "veridyn/estimation/regression/structure_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;
using testing_support::correlated_noise;

/// Constant, six correlated terms and three products; z depends on columns 0, 1, 3 and 7 (the product 1 * 2).
RegressionData candidates(unsigned seed, double noise, double rho = 0.0, Index N = 800) {
  std::mt19937_64 generator(seed);
  RegressionData data;
  data.regressors.resize(N, 10);
  data.regressors.col(0).setOnes();
  for (Index j = 1; j < 7; ++j) data.regressors.col(j) = correlated_noise(generator, N, 0.9);
  data.regressors.col(4) = 0.7 * data.regressors.col(4) + 0.7 * data.regressors.col(3);  // a distractor close to a term
  data.regressors.col(7) = data.regressors.col(1).cwiseProduct(data.regressors.col(2));
  data.regressors.col(8) = data.regressors.col(1).cwiseProduct(data.regressors.col(1));
  data.regressors.col(9) = data.regressors.col(3).cwiseProduct(data.regressors.col(5));
  for (Index j = 0; j < 10; ++j) data.parameter_names.push_back("c" + std::to_string(j));
  data.regressand = 0.5 * data.regressors.col(0) + 1.0 * data.regressors.col(1) - 0.8 * data.regressors.col(3) +
                    0.6 * data.regressors.col(7) + noise * correlated_noise(generator, N, rho);
  return data;
}

const std::vector<Index> kTrue{0, 1, 3, 7};

class StructureSearchOf : public ::testing::TestWithParam<StructureMethod> {};

TEST_P(StructureSearchOf, FindsTheTermsAmongDistractorsOverSeeds) {
  int right = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const StructureSearch search = search_structure(candidates(seed, 0.4), {.method = GetParam()});
    for (const Index j : kTrue) EXPECT_THAT(search.selected, ::testing::Contains(j)) << seed;
    right += search.selected == kTrue;
  }
  // Stepwise with F >= 20 and 0.5 % of the variance lets nothing else in; the orthogonal search's penalty is weaker for
  // terms of almost no effect, and drops them by their contribution only.
  EXPECT_GE(right, GetParam() == StructureMethod::kStepwise ? 50 : 45);
}

TEST_P(StructureSearchOf, KeepsItsHeadWithColouredResiduals) {
  int extra = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const StructureSearch search = search_structure(candidates(seed, 0.4, 0.8), {.method = GetParam()});
    for (const Index j : kTrue) EXPECT_THAT(search.selected, ::testing::Contains(j)) << seed;
    extra += static_cast<int>(search.selected.size()) - 4;
  }
  EXPECT_LE(extra, 15);
}

TEST_P(StructureSearchOf, ItsHistoryAddsUp) {
  const RegressionData data = candidates(3, 0.4);
  const StructureSearch search = search_structure(data, {.method = GetParam()});
  ASSERT_GE(search.history.size(), 5u);
  EXPECT_EQ(search.history.front().action, StructureAction::kStart);
  EXPECT_EQ(search.history.front().terms, 1);
  const double N = 800.0;
  double r2 = 0.0;
  for (const StructureStep& step : search.history) {
    if (!step.in_model) continue;
    r2 += step.r2_change;
    EXPECT_NEAR(step.r2, r2, 1e-12);
    // The columns of the table are functions of each other.
    const double squares = step.residual_sd * step.residual_sd * (N - static_cast<double>(step.terms));
    const double total = (data.regressand.array() - data.regressand.mean()).square().sum();
    EXPECT_NEAR(step.r2, 1.0 - squares / total, 1e-10);
    EXPECT_NEAR(step.pse, squares / N + search.penalty * total / N * static_cast<double>(step.terms) / N, 1e-10);
    EXPECT_GT(step.press, squares);
  }
  EXPECT_NEAR(search.estimate.r_squared, r2, 1e-10);
  EXPECT_THAT(search.text, ::testing::HasSubstr("keeps 4 of 10 candidate terms (c0, c1, c3, c7)"));
  EXPECT_FALSE(search.history.back().in_model);
  EXPECT_FALSE(search.history.back().reason.empty());
}

INSTANTIATE_TEST_SUITE_P(Methods, StructureSearchOf,
                         ::testing::Values(StructureMethod::kStepwise, StructureMethod::kOrthogonal),
                         [](const auto& which) {
                           return which.param == StructureMethod::kStepwise ? "Stepwise" : "Orthogonal";
                         });

TEST(StructureSearch, PressIsTheSumOfErrorsOfLeavingEachRowOut) {
  RegressionData data = candidates(5, 0.4, 0.0, 60);
  const StructureSearch search = search_structure(data);
  const StructureStep& last = search.history[search.estimate.parameters.size() - 1];
  ASSERT_EQ(last.terms, static_cast<Index>(search.selected.size()));
  const RegressionData chosen = select_columns(data, search.selected);
  double press = 0.0;
  for (Index k = 0; k < 60; ++k) {
    RowMatrix X(59, chosen.parameters());
    Eigen::VectorXd z(59);
    X << chosen.regressors.topRows(k), chosen.regressors.bottomRows(59 - k);
    z << chosen.regressand.head(k), chosen.regressand.tail(59 - k);
    const Eigen::VectorXd theta = numerics::HouseholderQr(X).solve(z);
    press += std::pow(chosen.regressand(k) - chosen.regressors.row(k).dot(theta), 2);
  }
  EXPECT_NEAR(last.press, press, 1e-9 * press);
}

TEST(StructureSearch, RemovesATermThatOthersMakeSuperfluous) {
  // c3 = c1 + c2 + a little noise enters first; once c1 and c2 are in, it has nothing left to say.
  std::mt19937_64 generator(2);
  RegressionData data;
  const Index N = 3000;
  data.regressors.resize(N, 4);
  data.regressors.col(0).setOnes();
  data.regressors.col(1) = correlated_noise(generator, N, 0.5);
  data.regressors.col(2) = correlated_noise(generator, N, 0.5);
  data.regressors.col(3) = data.regressors.col(1) + data.regressors.col(2) + 0.3 * correlated_noise(generator, N, 0.5);
  data.regressand = data.regressors.col(1) + data.regressors.col(2) + 0.05 * correlated_noise(generator, N, 0.0);
  data.parameter_names = {"1", "a", "b", "sum"};
  const StructureSearch search = search_structure(data, {.min_r2_change = 1e-4});
  EXPECT_EQ(search.history[1].term, "sum");
  EXPECT_THAT(search.history,
              ::testing::Contains(::testing::AllOf(::testing::Field(&StructureStep::action, StructureAction::kRemove),
                                                   ::testing::Field(&StructureStep::term, "sum"))));
  EXPECT_EQ(search.selected, (std::vector<Index>{0, 1, 2}));
}

TEST(StructureSearch, AColumnThatRepeatsAnotherCannotEnter) {
  RegressionData data = candidates(4, 0.4);
  data.regressors.col(9) = 2.0 * data.regressors.col(1);
  for (const StructureMethod method : {StructureMethod::kStepwise, StructureMethod::kOrthogonal}) {
    const StructureSearch search = search_structure(data, {.method = method});
    EXPECT_EQ(search.selected.size(), 4u);
    EXPECT_TRUE(search.estimate.usable());
  }
}

TEST(StructureSearch, KeepsWhatItIsToldTo) {
  const StructureSearch search = search_structure(candidates(1, 0.4), {.always = {5}});
  EXPECT_EQ(search.selected, (std::vector<Index>{0, 1, 3, 5, 7}));
}

TEST(StructureSearch, RefusesOptionsThatMakeNoSense) {
  const RegressionData data = candidates(1, 0.4);
  const auto message = [&](const StructureOptions& options) -> std::string {
    try {
      static_cast<void>(search_structure(data, options));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message({.f_enter = 10.0, .f_remove = 20.0}),
            "structure_search.f_remove: is 20; must be from 0 to f_enter = 10");
  EXPECT_EQ(message({.f_enter = std::nan("")}), "structure_search.f_enter: is nan; must be > 0");
  EXPECT_EQ(message({.always = {10}}), "structure_search.always: is 10; must be a column, 0 to 9");
}

}  // namespace
}  // namespace veridyn::estimation
