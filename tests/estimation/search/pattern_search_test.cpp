#include "veridyn/estimation/search/pattern_search.hpp"

#include <gtest/gtest.h>

#include "tests/estimation/search/search_problems.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

SearchResult pattern(BlackBoxProblem problem, const Eigen::VectorXd& start, const PatternOptions& options = {}) {
  Progress progress;
  BatchEvaluator evaluator(std::move(problem), {}, progress);
  return pattern_search(evaluator, start, options);
}

TEST(PatternSearch, FindsTheMinimumOfRosenbrocksValley) {
  const SearchResult r = pattern(rosenbrock(2), Eigen::Vector2d(-1.2, 1.0));
  EXPECT_EQ(r.termination, SearchTermination::kConverged) << r.message();
  // The mesh ends at 4e-6; the valley's curvature along its bottom is 0.4, so that f ends below 1e-10.
  EXPECT_LT(r.values.objective, 1e-9) << r.message();
  EXPECT_NEAR(r.x(0), 1.0, 1e-4);
  EXPECT_NEAR(r.x(1), 1.0, 1e-4);
  EXPECT_LT(r.evaluations, 2000U);
}

TEST(PatternSearch, FindsTheMinimumInFiveDimensions) {
  const SearchResult r =
      pattern(rosenbrock(5), Eigen::VectorXd::Constant(5, 0.3), {.tolerance = 1e-7, .iterations = 5000});
  EXPECT_LT(r.values.objective, 1e-6) << r.message();
  EXPECT_LT((r.x.array() - 1.0).abs().maxCoeff(), 5e-3);
}

TEST(PatternSearch, NelderMeadSavesEvaluations) {
  const Eigen::Vector2d start(-1.2, 1.0);
  const SearchResult with = pattern(rosenbrock(2), start);
  const SearchResult without = pattern(rosenbrock(2), start, {.iterations = 20000, .nelder_mead = false});
  EXPECT_LT(without.values.objective, 1e-4) << without.message();
  EXPECT_LT(with.evaluations, without.evaluations / 2) << with.message() << "\n" << without.message();
}

TEST(PatternSearch, EndsOnTheConstraintWhereTheMinimumIs) {
  const SearchResult r = pattern(disc(), Eigen::Vector2d(0.1, 0.2));
  EXPECT_TRUE(r.usable()) << r.message();
  EXPECT_NEAR(r.values.objective, -2.0, 1e-5) << r.message();
  EXPECT_NEAR(r.x(0), -1.0, 5e-3);
  EXPECT_NEAR(r.x(1), -1.0, 5e-3);
}

TEST(PatternSearch, LeavesAnInfeasibleStart) {
  const SearchResult r = pattern(disc(), Eigen::Vector2d(1.4, -1.9));
  EXPECT_TRUE(r.usable()) << r.message();
  EXPECT_NEAR(r.values.objective, -2.0, 1e-5) << r.message();
}

TEST(PatternSearch, CountsWhatCouldNotBeComputed) {
  const SearchResult r = pattern(disc(), Eigen::Vector2d(1.45, 1.9));
  EXPECT_GT(r.failed, 0U);
  EXPECT_TRUE(r.usable()) << r.message();
}

TEST(PatternSearch, ScalesEachCoordinateByItself) {
  // An ellipse with half axes of 1 and 1000 within the bounds.
  BlackBoxProblem p = box("ellipse", 2, -2000.0, 2000.0);
  p.evaluate = [](const Eigen::VectorXd& x) {
    return SearchValues{.objective = std::pow(x(0) - 3.0, 2) + std::pow((x(1) - 700.0) / 1000.0, 2)};
  };
  const SearchResult r = pattern(std::move(p), Eigen::Vector2d(-500.0, -900.0), {.tolerance = 1e-7});
  EXPECT_NEAR(r.x(0), 3.0, 1e-2) << r.message();
  EXPECT_NEAR(r.x(1), 700.0, 10.0);
}

TEST(PatternSearch, RefusesAStartOutsideTheBounds) {
  EXPECT_THROW((void)pattern(disc(), Eigen::Vector2d(3.0, 0.0)), InputError);
  EXPECT_THROW((void)pattern(disc(), Eigen::Vector2d(std::nan(""), 0.0)), InputError);
  EXPECT_THROW((void)pattern(disc(), Eigen::Vector2d(0.0, std::nan(""))), InputError);
  EXPECT_THROW((void)pattern(disc(), Eigen::Vector2d(0.0, 0.0), {.tolerance = 0.5}), InputError);
}

}  // namespace
}  // namespace veridyn::estimation
