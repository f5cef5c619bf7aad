#include "veridyn/estimation/search/black_box_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/search/search_problems.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

TEST(BlackBoxProblem, RefusesBoundsThatCross) {
  Progress progress;
  BlackBoxProblem p = disc();
  p.high(1) = -2.0;
  EXPECT_THROW(BatchEvaluator(p, {}, progress), InputError);
  p.high(1) = std::nan("");
  EXPECT_THROW(BatchEvaluator(p, {}, progress), InputError);
}

TEST(SearchValues, AreOrderedByFeasibilityFirst) {
  const double nan = std::nan("");
  const SearchValues low{.objective = 1.0, .constraints = {-1.0}}, high{.objective = 2.0, .constraints = {0.0}};
  const SearchValues out{.objective = 0.0, .constraints = {0.1}}, far{.objective = -9.0, .constraints = {0.2}};
  const SearchValues failed{.objective = nan, .constraints = {-1.0}}, tiny{.objective = 0.0, .constraints = {1e-300}};
  EXPECT_TRUE(better(low, high));
  EXPECT_TRUE(better(high, out));
  EXPECT_TRUE(better(out, far));
  EXPECT_TRUE(better(far, failed));
  EXPECT_FALSE(better(failed, failed));
  EXPECT_FALSE(low.feasible() && tiny.feasible());
}

}  // namespace
}  // namespace veridyn::estimation
