#include "veridyn/estimation/search/search_log.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/estimation/search/search_problems.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::estimation {
namespace {

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

TEST(SearchLog, RefusesTheLogOfAnotherSearchSayingWhatDiffers) {
  const test::TemporaryFolder folder;
  const std::filesystem::path log = folder.path() / "log.csv";
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
  const test::TemporaryFolder folder;
  const std::filesystem::path log = folder.path() / "log.csv";
  Progress progress;
  {
    BatchEvaluator evaluator(disc(), {.log = log}, progress);
    (void)particle_swarm(evaluator, {.particles = 12, .iterations = 3, .seed = 2});
  }
  EXPECT_NE(refusal_of(disc(), log).find("evaluation 1 is at another point"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::estimation
