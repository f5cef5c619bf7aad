#include "veridyn/estimation/search/batch_evaluator.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "tests/estimation/search/search_problems.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/estimation/search/particle_swarm.hpp"
#include "veridyn/estimation/search/pattern_search.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

/// Points and values of all evaluations, without their times.
std::vector<double> numbers(const BatchEvaluator& evaluator) {
  std::vector<double> all;
  for (const SearchEvaluation& e : evaluator.evaluations()) {
    all.insert(all.end(), e.x.begin(), e.x.end());
    for (const double v : {e.values.objective, e.values.constraints[0]}) all.push_back(v == v ? v : -1e300);
  }
  return all;
}

TEST(BatchEvaluator, GivesTheSameBitsOnAnyNumberOfThreads) {
  std::vector<double> first;
  for (const int threads : {1, 2, 5}) {
    CountingProgress progress(threads);
    BatchEvaluator evaluator(disc(), {}, progress);
    const SearchResult r = both(evaluator);
    EXPECT_NEAR(r.values.objective, -2.0, 1e-3) << r.message();
    if (first.empty()) first = numbers(evaluator);
    EXPECT_EQ(numbers(evaluator), first) << threads;
  }
}

TEST(BatchEvaluator, EvaluatesNoPointTwice) {
  std::atomic<int> calls = 0;
  BlackBoxProblem p = disc();
  p.evaluate = [&, f = p.evaluate](const Eigen::VectorXd& x) { return ++calls, f(x); };
  Progress progress;
  BatchEvaluator evaluator(p, {}, progress);
  const std::vector<Eigen::VectorXd> points = {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 0)};
  std::vector<SearchValues> values;
  ASSERT_TRUE(evaluator.evaluate(points, values));
  ASSERT_TRUE(evaluator.evaluate(points, values));
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(values[0].objective, values[2].objective);
  EXPECT_EQ(values[1].objective, 1.0);
}

TEST(BatchEvaluator, ResumedAtAnyPointEndsAsIfNeverInterrupted) {
  CountingProgress calm;
  BatchEvaluator whole(disc(), {}, calm);
  const SearchResult expected = both(whole);
  const test::TemporaryFolder temporary;
  const std::filesystem::path& folder = temporary.path();
  numerics::RandomStream random(7, "interruptions");
  for (int trial = 0; trial < 20; ++trial) {
    const std::filesystem::path log = folder / ("log" + std::to_string(trial) + ".csv");
    int interruptions = 0;
    for (bool done = false; !done && interruptions < 1000; ++interruptions) {
      CountingProgress progress(1 + trial % 2, static_cast<long>(5 + random.index(300)));
      BatchEvaluator evaluator(disc(), {.log = log}, progress);
      const SearchResult r = both(evaluator);
      done = r.termination != SearchTermination::kInterrupted;
      if (!done) {
        // What a killed program leaves of a batch that it was writing.
        std::string text = read_file(log);
        const std::string begun = "77,0.1,done,0.25,";
        write_file(log, text + begun.substr(0, random.index(begun.size())));
        continue;
      }
      EXPECT_EQ(r.x, expected.x);
      EXPECT_EQ(r.values.objective, expected.values.objective);
      EXPECT_EQ(numbers(evaluator), numbers(whole));
    }
    EXPECT_GT(interruptions, 1);
  }
}

TEST(BatchEvaluator, StopsBeforeABatchThatIsTooMuch) {
  Progress progress;
  BatchEvaluator evaluator(disc(), {.max_evaluations = 30}, progress);
  const SearchResult r = particle_swarm(evaluator, {.particles = 12});
  EXPECT_EQ(r.termination, SearchTermination::kEvaluations);
  EXPECT_EQ(evaluator.evaluations().size(), 24U);
}

}  // namespace
}  // namespace veridyn::estimation
