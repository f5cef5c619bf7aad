#include "veridyn/muscle/identification/task_advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/identify_muscles.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::HasSubstr;

TaskStudy advice_study(int seed, const std::string& tasks, const std::string& parameters,
                       const std::string& more = "") {
  Progress progress;
  const std::string text = fmt::format(
      "seed = {}\n[subject]\nmodel = \"arm\"\npaths = \"fitted\"\n[tasks]\nnumbers = {}\n{}[person]\nspread = \"5 %\"\n"
      "[identify]\nstarts = 1\n{}",
      seed, tasks, parameters, more);
  return read_task_study(Study::parse(text, "s.toml"), progress);
}

/// F0 and LS of a flexor and an extensor.
const std::string kFour =
    "[[parameter]]\nmuscles = [\"triceps_long\"]\nfields = [\"max_isometric_force\"]\nbounds = \"20 %\"\n"
    "[[parameter]]\nmuscles = [\"triceps_long\"]\nfields = [\"tendon_slack_length\"]\nbounds = \"20 %\"\n"
    "[[parameter]]\nmuscles = [\"biceps_long\"]\nfields = [\"max_isometric_force\"]\nbounds = \"20 %\"\n"
    "[[parameter]]\nmuscles = [\"biceps_long\"]\nfields = [\"tendon_slack_length\"]\nbounds = \"20 %\"\n";

struct Foretold {
  TaskAdvice before, after;
  /// Lessening of the widest interval over what was foretold.
  [[nodiscard]] double ratio() const {
    return (before.now.share - after.now.share) / (before.now.share - before.tasks.front().then.share);
  }
};

/// Takes the advice and estimates again.
Foretold taken(int seed, const std::vector<int>& tasks, const std::string& parameters) {
  Progress progress;
  Foretold f;
  f.before = identify(advice_study(seed, fmt::format("[{}]", fmt::join(tasks, ",")), parameters), progress).advice;
  if (f.before.tasks.empty()) throw std::runtime_error("nothing advised: " + f.before.withheld);
  std::vector<int> more = tasks;
  more.push_back(f.before.tasks.front().number);
  f.after = identify(advice_study(seed, fmt::format("[{}]", fmt::join(more, ",")), parameters), progress).advice;
  return f;
}

TEST(TaskAdvice, ATaskLessensTheWidestIntervalByWhatWasForetold) {
  for (const int seed : {1, 2}) {
    const Foretold f = taken(seed, {8, 12, 29}, kFour);
    const AdvisedTask& best = f.before.tasks.front();
    EXPECT_LT(best.then.share, 0.9 * f.before.now.share);
    EXPECT_NEAR(f.ratio(), 1.0, 0.2) << best.name << ": " << f.before.now.share << " -> " << best.then.share << ", was "
                                     << f.after.now.share;
    EXPECT_TRUE(std::is_sorted(f.before.tasks.begin(), f.before.tasks.end(),
                               [](const auto& a, const auto& b) { return a.then.share < b.then.share; }));
    for (const AdvisedTask& task : f.before.tasks) {
      EXPECT_TRUE(task.number != 8 && task.number != 12 && task.number != 29);
      EXPECT_LE(task.then.share, f.before.now.share * (1.0 + 1e-12)) << task.name;
    }
    EXPECT_TRUE(std::none_of(f.after.tasks.begin(), f.after.tasks.end(),
                             [&](const auto& task) { return task.number == best.number; }));
  }
}

TEST(TaskAdvice, IsForTheModelsTasksAndWithheldWhereTheModelIsWrong) {
  EXPECT_TRUE(advice_study(1, "[8]", kFour).advice);
  EXPECT_FALSE(advice_study(1, "[8]", kFour, "advice = false\n").advice);
  Progress progress;
  const std::string own =
      "[subject]\nmodel = \"arm\"\n[person]\n[[task]]\nname = \"curl\"\n[[task.ramp]]\ncoordinate = \"elbow_flexion\"\n"
      "to = \"90 deg\"\n[tasks]\nload_body = \"hand\"\n[identify]\nadvice = ";
  try {
    static_cast<void>(read_task_study(Study::parse(own + "true\n", "s.toml"), progress));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("needs the elbow tasks: load_body: 'hand' is no body"));
  }
  EXPECT_FALSE(read_task_study(Study::parse(own + "false\n", "s.toml"), progress).advice);
  TaskStudy wrong = advice_study(1, "[8, 29]", kFour);
  wrong.person->millard = true;
  const MuscleAnalysis a = identify(wrong, progress);
  EXPECT_THAT(a.advice.withheld, HasSubstr("noise"));
  EXPECT_TRUE(a.advice.tasks.empty());
  EXPECT_TRUE(a.estimate.next_measurements.empty());
}

/// 18 unknowns, three or four tasks: the widest interval is nearly the prior's, and sensitivities change within it.
TEST(TaskAdviceSoak, OfManyPersons) {
  std::vector<double> few, all;
  for (int seed = 1; seed <= 10; ++seed) {
    const Foretold f = taken(seed, {8, 12, 29}, kFour), g = taken(seed, {8, 12, 29, 33}, "");
    few.push_back(f.ratio());
    all.push_back(g.after.now.share / g.before.tasks.front().then.share);
    fmt::print("{}: 4 unknowns {:.3g} -> {:.3g}, was {:.3g}; 18 unknowns {:.3g} -> {:.3g}, was {:.3g}\n", seed,
               f.before.now.share, f.before.tasks.front().then.share, f.after.now.share, g.before.now.share,
               g.before.tasks.front().then.share, g.after.now.share);
    std::fflush(stdout);
  }
  for (const double ratio : few) EXPECT_NEAR(ratio, 1.0, 0.2);
  for (const double ratio : all) EXPECT_NEAR(ratio, 1.0, 0.25);
}

}  // namespace
}  // namespace veridyn::muscle
