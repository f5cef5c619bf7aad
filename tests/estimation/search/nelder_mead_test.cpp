#include "veridyn/estimation/search/nelder_mead.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/search/search_problems.hpp"

namespace veridyn::estimation {
namespace {

/// (x - 1)^2 + (y + 0.5)^2.
BlackBoxProblem paraboloid() {
  BlackBoxProblem p = box("paraboloid", 2, -4.0, 4.0);
  p.evaluate = [](const Eigen::VectorXd& x) {
    return SearchValues{.objective = std::pow(x(0) - 1.0, 2) + std::pow(x(1) + 0.5, 2)};
  };
  return p;
}

std::vector<SearchPoint> simplex_at(BatchEvaluator& evaluator, const std::vector<Eigen::VectorXd>& points) {
  std::vector<SearchValues> values;
  EXPECT_TRUE(evaluator.evaluate(points, values));
  std::vector<SearchPoint> simplex;
  for (std::size_t i = 0; i < points.size(); ++i) simplex.push_back({points[i], values[i]});
  return simplex;
}

Eigen::VectorXd as_it_is(const Eigen::VectorXd& x) { return x; }

// Of (0, 0), (0, -1) and (-1, 0) the last is the worst; the mean of the others is (0, -0.5). Reflected it is (1, -1),
// better than all; expanded (2, -1.5), which is worse again: the reflection stays.
TEST(MoveSimplex, ReflectsAndExpandsAsNelderAndMeadSay) {
  Progress progress;
  BatchEvaluator evaluator(paraboloid(), {}, progress);
  const auto simplex =
      simplex_at(evaluator, {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.0, -1.0), Eigen::Vector2d(-1.0, 0.0)});
  std::vector<Eigen::VectorXd> tried;
  const auto watched = [&tried](const Eigen::VectorXd& x) {
    tried.push_back(x);
    return x;
  };
  const SimplexMoves moves = move_simplex(evaluator, simplex, watched, 2);
  ASSERT_GE(tried.size(), 2U);
  EXPECT_LT((tried[0] - Eigen::Vector2d(1.0, -1.0)).norm(), 1e-12);
  EXPECT_LT((tried[1] - Eigen::Vector2d(2.0, -1.5)).norm(), 1e-12);
  EXPECT_TRUE(moves.completed);
  EXPECT_LT((moves.simplex[0].x - Eigen::Vector2d(1.0, -1.0)).norm(), 1e-12);
}

TEST(MoveSimplex, ComesToTheMinimumAndIsSortedByValue) {
  Progress progress;
  BatchEvaluator evaluator(paraboloid(), {}, progress);
  const auto simplex =
      simplex_at(evaluator, {Eigen::Vector2d(-3.0, -3.0), Eigen::Vector2d(-2.0, -3.0), Eigen::Vector2d(-3.0, -2.0)});
  const SimplexMoves moves = move_simplex(evaluator, simplex, as_it_is, 80);
  ASSERT_EQ(moves.simplex.size(), 3U);
  EXPECT_LT(moves.simplex[0].values.objective, 1e-3);
  for (std::size_t i = 1; i < 3; ++i) EXPECT_FALSE(better(moves.simplex[i].values, moves.simplex[i - 1].values));
}

TEST(MoveSimplex, KeepsToItsEvaluations) {
  Progress progress;
  BatchEvaluator evaluator(paraboloid(), {}, progress);
  const auto simplex =
      simplex_at(evaluator, {Eigen::Vector2d(-3.0, -3.0), Eigen::Vector2d(-2.0, -3.0), Eigen::Vector2d(-3.0, -2.0)});
  static_cast<void>(move_simplex(evaluator, simplex, as_it_is, 5));
  EXPECT_LE(evaluator.evaluations().size(), 3U + 5U);
}

// On a mesh of 1 the simplex ends where its next point is one of its own: it cannot collapse below the mesh.
TEST(MoveSimplex, EndsWhereTheMeshLeavesNoOtherPoint) {
  Progress progress;
  BatchEvaluator evaluator(paraboloid(), {}, progress);
  const auto simplex =
      simplex_at(evaluator, {Eigen::Vector2d(-3.0, -3.0), Eigen::Vector2d(-2.0, -3.0), Eigen::Vector2d(-3.0, -2.0)});
  const auto snap = [](const Eigen::VectorXd& x) -> Eigen::VectorXd { return x.array().round(); };
  const SimplexMoves moves = move_simplex(evaluator, simplex, snap, 1000);
  EXPECT_TRUE(moves.completed);
  EXPECT_LT(evaluator.evaluations().size(), 100U);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(moves.simplex[i].x, moves.simplex[j].x);
  EXPECT_LE(moves.simplex[0].values.objective, 1.25) << "a neighbour of the minimum on the mesh";
}

TEST(MoveSimplex, SaysThatTheEvaluatorEnded) {
  Progress progress;
  BatchEvaluator evaluator(paraboloid(), {.max_evaluations = 4}, progress);
  const auto simplex =
      simplex_at(evaluator, {Eigen::Vector2d(-3.0, -3.0), Eigen::Vector2d(-2.0, -3.0), Eigen::Vector2d(-3.0, -2.0)});
  EXPECT_FALSE(move_simplex(evaluator, simplex, as_it_is, 100).completed);
}

}  // namespace
}  // namespace veridyn::estimation
