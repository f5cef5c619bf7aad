#include "veridyn/estimation/search/particle_swarm.hpp"

#include <gtest/gtest.h>

#include "tests/estimation/search/search_problems.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

TEST(ParticleSwarm, FindsTheDeepestOfManyMinima) {
  Progress progress;
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    BatchEvaluator evaluator(rastrigin(3), {}, progress);
    const SearchResult r = particle_swarm(evaluator, {.particles = 40, .iterations = 300, .seed = seed});
    found += r.values.objective < 1e-4 && (r.x.array() - 0.7).abs().maxCoeff() < 1e-2 ? 1 : 0;
  }
  // Of some 1300 local minima; the second deepest is 1 higher.
  EXPECT_GE(found, 9);
}

TEST(ParticleSwarm, EndsWithTheFirstFeasiblePointWhenAsked) {
  // Feasible: a ball of 1e-4 of the box's volume.
  BlackBoxProblem p = box("ball", 4, 0.0, 1.0);
  p.constraint_names = {"distance"};
  p.evaluate = [](const Eigen::VectorXd& x) {
    return SearchValues{.objective = x.sum(), .constraints = {(x.array() - 0.6).matrix().norm() - 0.067}};
  };
  CountingProgress progress;
  BatchEvaluator evaluator(p, {}, progress);
  const SearchResult r = particle_swarm(evaluator, {.swarms = 5, .stop_at_feasible = true});
  EXPECT_EQ(r.termination, SearchTermination::kFeasible) << r.message();
  EXPECT_TRUE(r.usable());
  EXPECT_LT(r.evaluations, 5000U);
}

TEST(ParticleSwarm, RepeatsUntilFeasibleAndSaysWhenNothingIs) {
  BlackBoxProblem p = box("none", 2, 0.0, 1.0);
  p.constraint_names = {"never"};
  p.evaluate = [](const Eigen::VectorXd& x) {
    return SearchValues{.objective = 0.0, .constraints = {1.0 + x.squaredNorm()}};
  };
  Progress progress;
  BatchEvaluator evaluator(p, {}, progress);
  const SearchResult r = particle_swarm(
      evaluator, {.particles = 10, .iterations = 20, .swarms = 3, .stop_at_feasible = true, .tolerance = 0.0});
  EXPECT_EQ(r.iterations, 60U);
  EXPECT_FALSE(r.usable());
  EXPECT_NEAR(r.values.violation(), 1.0, 1e-3) << r.message();  // at the corner, though none is feasible
  EXPECT_NE(r.message().find("do not hold"), std::string::npos) << r.message();
}

TEST(ParticleSwarm, StaysWithinTheBoundsAndUsesUpWhatItMay) {
  BlackBoxProblem p = box("slope", 3, -1.0, 2.0);
  double least = 0.0;
  p.evaluate = [&](const Eigen::VectorXd& x) {
    least = std::min(least, x.minCoeff());
    return SearchValues{.objective = x.sum()};
  };
  CountingProgress progress(1);
  BatchEvaluator evaluator(p, {.max_evaluations = 400}, progress);
  const SearchResult r = particle_swarm(evaluator);
  EXPECT_EQ(least, -1.0);
  EXPECT_EQ(r.values.objective, -3.0);
  EXPECT_LE(evaluator.evaluations().size(), 400U);
}

TEST(ParticleSwarm, RefusesTooFewParticles) {
  Progress progress;
  BatchEvaluator evaluator(rastrigin(2), {}, progress);
  EXPECT_THROW((void)particle_swarm(evaluator, {.particles = 2}), InputError);
  EXPECT_THROW((void)particle_swarm(evaluator, {.iterations = 0}), InputError);
}

}  // namespace
}  // namespace veridyn::estimation
