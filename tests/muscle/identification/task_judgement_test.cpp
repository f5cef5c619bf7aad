#include "veridyn/muscle/identification/task_judgement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using ::testing::HasSubstr;

/// An estimate of two parameters from two tasks, with one more held out, that nothing is to be said against; each test
/// spoils one thing.
struct Findings {
  TaskEstimate estimate;
  std::vector<TaskOutcome> tasks;
  std::vector<std::string> unused, wraps;

  Findings() {
    for (const char* name : {"strength", "length"})
      estimate.best.parameters.push_back({.name = name, .value = 1.0, .sigma = 0.01});
    estimate.verdicts.assign(2, TaskVerdict::kIdentified);
    for (int i = 0; i < 3; ++i) estimate.searches.push_back({.cost = 10.0, .agrees = true, .message = "converged"});
    estimate.chi_square = 1.0;
    estimate.freedom = 200.0;
    for (int i = 0; i < 3; ++i) {
      TaskOutcome task{.name = "task " + std::to_string(i + 1), .hold_out = i == 2};
      task.before = {.rmse = 0.1, .nrmse = 0.1, .range = 1.0, .moves = true};
      task.after = {.rmse = 1e-3, .nrmse = 1e-3, .range = 1.0, .moves = true};
      task.estimated = estimation::RowMatrix::Ones(1, 1);
      tasks.push_back(task);
    }
  }

  [[nodiscard]] std::vector<Evidence> rows() const {
    return judge_tasks({.estimate = estimate,
                        .tasks = tasks,
                        .unused = unused,
                        .wrap_warnings = wraps,
                        .noise_known = true,
                        .noise = 1e-3});
  }
  [[nodiscard]] Evidence row(const std::string& name) const {
    const std::vector<Evidence> all = rows();
    const auto found = std::find_if(all.begin(), all.end(), [&](const Evidence& r) { return r.name == name; });
    if (found == all.end()) throw std::runtime_error("no row " + name);
    return *found;
  }
};

TEST(JudgeTasks, AGoodEstimatePassesAllButWhatIsTakenAsGiven) {
  for (const Evidence& row : Findings().rows())
    EXPECT_EQ(row.outcome, row.name == "what is taken as given" ? Outcome::kNotVerified : Outcome::kPassed) << row.name;
}

TEST(JudgeTasks, AParameterAtItsBoundHasARowOfItsOwn) {
  Findings f;
  f.estimate.verdicts[1] = TaskVerdict::kAtBound;
  const Evidence row = f.row("parameter at its bound");
  EXPECT_EQ(row.about, "length");
  EXPECT_EQ(row.outcome, Outcome::kCare);
  EXPECT_THAT(row.text, HasSubstr("length ended at its bound 1 1"));
  EXPECT_THAT(f.row(kDetermined).text, HasSubstr("1 of 2 parameters; not length"));
}

TEST(JudgeTasks, SearchesThatEndElsewhereWithAsGoodAFitAreSaidSo) {
  Findings f;
  f.estimate.searches[2].agrees = false;
  EXPECT_THAT(f.row("searches agree").text, HasSubstr("the best of 3 searches is reported"));
  EXPECT_EQ(f.row("searches agree").outcome, Outcome::kPassed);
  f.estimate.ambiguous = true;
  EXPECT_EQ(f.row("searches agree").outcome, Outcome::kCare);
  EXPECT_THAT(f.row("searches agree").text, HasSubstr("more than one explanation"));
  for (TaskSearch& s : f.estimate.searches) s.cost = kNaN;
  f.estimate.searches[0].cost = 10.0;
  EXPECT_EQ(f.row("searches agree").outcome, Outcome::kNotVerified);
}

TEST(JudgeTasks, TasksInAWrapsFadingBandAreNamed) {
  Findings f;
  f.wraps = {"task 1: triceps_long is in a band", "task 2: biceps_long is in a band"};
  EXPECT_EQ(f.row("wraps of muscles").outcome, Outcome::kCare);
  EXPECT_THAT(f.row("wraps of muscles").text, HasSubstr("triceps_long is in a band (and 1 more)"));
}

TEST(JudgeTasks, ReservesThatCarryTooMuchAreNamedWithTheirTask) {
  Findings f;
  f.tasks[1].reserve_share = 0.12;
  f.tasks[2].reserve_share = 0.5;  // held out: nothing is estimated from it
  EXPECT_EQ(f.row("torque that reserves carry").outcome, Outcome::kCare);
  EXPECT_THAT(f.row("torque that reserves carry").text, HasSubstr("up to 12.0 % of what the muscles do (task 2)"));
}

TEST(JudgeTasks, TasksThatHardlyMoveOrCannotFinishAreNamed) {
  Findings f;
  f.tasks[0].before.moves = false;
  f.tasks[1].estimated = {};
  f.unused = {"task 9: cannot be followed"};
  const Evidence row = f.row("tasks");
  EXPECT_EQ(row.outcome, Outcome::kCare);
  EXPECT_THAT(row.text, HasSubstr("without an NRMSE: task 1"));
  EXPECT_THAT(row.text, HasSubstr("1 of 3 simulations cannot finish"));
  EXPECT_THAT(row.text, HasSubstr("left out: task 9"));
}

TEST(JudgeTasks, AResidualBeyondOrFarBelowTheNoiseIsSaidSo) {
  Findings f;
  f.estimate.chi_square = 4.0;
  EXPECT_EQ(f.row("residual against the noise").outcome, Outcome::kFailed);
  EXPECT_THAT(f.row("residual against the noise").text, HasSubstr("is 2 times the noise"));
  f.estimate.chi_square = 1.45;
  EXPECT_EQ(f.row("residual against the noise").outcome, Outcome::kCare);
  f.estimate.chi_square = 0.25;
  EXPECT_THAT(f.row("residual against the noise").text, HasSubstr("only 0.50 times"));
  f.estimate.chi_square = 1.0;
  f.estimate.lag1 = 0.8;
  EXPECT_EQ(f.row("correlation of the residual").outcome, Outcome::kCare);
}

TEST(JudgeTasks, UnseenTasksAreMeasuredAgainstNoiseAndStandardModel) {
  Findings f;
  TaskOutcome& unseen = f.tasks[2];
  unseen.after.rmse = unseen.after.nrmse = 0.05;
  EXPECT_EQ(f.row("hold-out").outcome, Outcome::kCare);
  unseen.after.rmse = unseen.after.nrmse = 0.2;
  EXPECT_EQ(f.row("hold-out").outcome, Outcome::kFailed);
  unseen.after.rmse = unseen.after.nrmse = kNaN;
  EXPECT_THAT(f.row("hold-out").text, HasSubstr("1 of 1 unseen tasks cannot be simulated"));
  f.tasks.pop_back();
  EXPECT_EQ(f.row("hold-out").outcome, Outcome::kMissing);
}

}  // namespace
}  // namespace veridyn::muscle
