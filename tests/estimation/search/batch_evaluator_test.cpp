#include "veridyn/estimation/search/batch_evaluator.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>

#include "tests/estimation/search/search_problems.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/estimation/search/particle_swarm.hpp"
#include "veridyn/estimation/search/pattern_search.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

/// Swarm, then pattern search from its best: the way of the published route.
SearchResult both(BatchEvaluator& evaluator) {
  const SearchResult start = particle_swarm(evaluator, {.particles = 12, .iterations = 15});
  if (start.termination == SearchTermination::kInterrupted) return start;
  return pattern_search(evaluator, start.x, {.tolerance = 1e-4});
}

std::filesystem::path empty_folder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

/// Points and values of all evaluations, without their times.
std::vector<double> numbers(const BatchEvaluator& evaluator) {
  std::vector<double> all;
  for (const SearchEvaluation& e : evaluator.evaluations()) {
    all.insert(all.end(), e.x.begin(), e.x.end());
    for (const double v : {e.values.objective, e.values.constraints[0]}) all.push_back(v == v ? v : -1e300);
  }
  return all;
}

std::string refusal_of(const BlackBoxProblem& problem, const std::filesystem::path& log) {
  Progress progress;
  try {
    BatchEvaluator evaluator(problem, {.log = log}, progress);
    (void)both(evaluator);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
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

TEST(BatchEvaluator, TwoProcessesEvaluateHalfEachAndComeToTheSameBits) {
  const std::filesystem::path folder = empty_folder("two_processes");
  Progress calm;
  BatchEvaluator alone(disc(), {}, calm);
  (void)both(alone);
  // The first goes on from what a single process left.
  std::size_t left = 0;
  {
    BatchEvaluator begun(disc(), {.max_evaluations = 50, .log = folder / "search.csv"}, calm);
    (void)both(begun);
    left = begun.evaluations().size();
  }
  ASSERT_GT(left, 0U);
  std::array<std::atomic<std::size_t>, 2> calls{};
  std::array<std::vector<double>, 2> found;
  std::vector<std::thread> processes;
  for (std::size_t p = 0; p < 2; ++p)
    processes.emplace_back([&, p] {
      numerics::ValueLog shared(folder, {.index = p, .count = 2, .wait = true});
      BlackBoxProblem problem = disc();
      problem.evaluate = [&, f = problem.evaluate](const Eigen::VectorXd& x) { return ++calls[p], f(x); };
      Progress progress;
      EvaluationOptions options{.shared = &shared};
      if (p == 0) options.log = folder / "search.csv";
      BatchEvaluator evaluator(problem, options, progress);
      (void)both(evaluator);
      found[p] = numbers(evaluator);
    });
  for (std::thread& p : processes) p.join();
  EXPECT_EQ(found[0], numbers(alone));
  EXPECT_EQ(found[1], numbers(alone));
  // Every point once, but for those that the single process left: the second may compute its share of them before the
  // first has told it. Many batches of a search in two dimensions have one point, which is the first process'.
  const std::size_t all = alone.evaluations().size();
  EXPECT_GE(calls[0] + calls[1], all - left);
  EXPECT_LE(calls[0] + calls[1], all);
  EXPECT_GT(calls[1], all / 8);
  std::filesystem::remove_all(folder);
}

TEST(BatchEvaluator, ResumedAtAnyPointEndsAsIfNeverInterrupted) {
  CountingProgress calm;
  BatchEvaluator whole(disc(), {}, calm);
  const SearchResult expected = both(whole);
  const std::filesystem::path folder = empty_folder("search_resumed");
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

TEST(SearchLog, RefusesTheLogOfAnotherSearchSayingWhatDiffers) {
  const std::filesystem::path log = empty_folder("search_log_refused") / "log.csv";
  BlackBoxProblem p = disc();
  p.identity = {{"tasks", "1 5"}};
  ASSERT_EQ(refusal_of(p, log), "");
  BlackBoxProblem other = p;
  other.identity[0].second = "1 6";
  EXPECT_NE(refusal_of(other, log).find("tasks is '1 5' there and '1 6' here"), std::string::npos);
  other = p;
  other.low(1) = -1.5;
  EXPECT_NE(refusal_of(other, log).find("parameter 2 is 'x2 from -2 to 2' there and 'x2 from -1.5 to 2' here"),
            std::string::npos);
  other = p;
  other.identity.clear();
  EXPECT_NE(refusal_of(other, log).find("tasks"), std::string::npos);
  const std::string text = read_file(log);
  std::string changed = text;
  changed.replace(changed.find("format 1"), 8, "format 9");
  write_file(log, changed);
  EXPECT_NE(refusal_of(p, log).find("has format 9"), std::string::npos);
  write_file(log, "time,x\n1,2\n");
  EXPECT_NE(refusal_of(p, log).find("no log of a search"), std::string::npos);
  // A digit of an early evaluation: damage, not a cut end.
  changed = text;
  const std::size_t row = changed.find("\n3,");
  changed[changed.find('.', row) + 3] ^= 1;
  write_file(log, changed);
  EXPECT_NE(refusal_of(p, log).find("is damaged after evaluation 0"), std::string::npos) << refusal_of(p, log);
}

TEST(SearchLog, RefusesPointsThatTheSearchDoesNotComeTo) {
  const std::filesystem::path log = empty_folder("search_log_points") / "log.csv";
  Progress progress;
  {
    BatchEvaluator evaluator(disc(), {.log = log}, progress);
    (void)particle_swarm(evaluator, {.particles = 12, .iterations = 3, .seed = 2});
  }
  EXPECT_NE(refusal_of(disc(), log).find("evaluation 1 is at another point"), std::string::npos);
}

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
