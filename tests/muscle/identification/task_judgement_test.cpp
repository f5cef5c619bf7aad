#include "veridyn/muscle/identification/task_judgement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::muscle {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;
using estimation::ParameterStatus;
using ::testing::HasSubstr;

/// An estimate of two parameters from two tasks, with one more held out, that nothing is to be said against; each test
/// spoils one thing.
struct Findings {
  TaskEstimate estimate;
  std::vector<TaskOutcome> tasks;
  std::vector<std::string> unused, wraps;

  Findings() {
    for (const char* name : {"strength", "length"})
      estimate.best.parameters.push_back(
          {.name = name, .value = 1.0, .sigma = 0.01, .status = ParameterStatus::kIdentified});
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
  [[nodiscard]] Evidence row(Check check) const {
    const std::vector<Evidence> all = rows();
    const auto found = std::ranges::find(all, check, &Evidence::check);
    if (found == all.end()) throw std::runtime_error("no row " + std::string(to_string(check)));
    return *found;
  }
};

TEST(JudgeTasks, AGoodEstimatePassesAllButWhatIsTakenAsGiven) {
  for (const Evidence& row : Findings().rows())
    EXPECT_EQ(row.outcome, row.check == Check::kTakenAsGiven ? Outcome::kNotVerified : Outcome::kPassed) << says(row);
}

TEST(JudgeTasks, AParameterAtItsBoundHasARowOfItsOwn) {
  Findings f;
  f.estimate.best.parameters[1].status = ParameterStatus::kAtBound;
  const Evidence row = f.row(Check::kAtBound);
  EXPECT_EQ(row.about, "length");
  EXPECT_EQ(row.outcome, Outcome::kCare);
  EXPECT_EQ(row.cause, Cause::kBound);
  EXPECT_THAT(says(row), HasSubstr("the search for length ended at 1"));
  const Evidence determined = f.row(Check::kDeterminedByTasks);
  EXPECT_EQ(determined.outcome, Outcome::kCare);
  EXPECT_EQ(determined.value, 1.0);
  EXPECT_EQ(determined.limit, 2.0);
  EXPECT_EQ(std::get<std::string>(determined.figure("open")->value), "length");
}

TEST(JudgeTasks, SearchesThatEndElsewhereWithAsGoodAFitAreSaidSo) {
  Findings f;
  f.estimate.searches[2].agrees = false;
  EXPECT_EQ(f.row(Check::kSearchesAgree).value, 2.0);
  EXPECT_EQ(f.row(Check::kSearchesAgree).outcome, Outcome::kPassed);
  f.estimate.ambiguous = true;
  EXPECT_EQ(f.row(Check::kSearchesAgree).outcome, Outcome::kCare);
  for (TaskSearch& s : f.estimate.searches) s.cost = kNaN;
  f.estimate.searches[0].cost = 10.0;
  EXPECT_EQ(f.row(Check::kSearchesAgree).outcome, Outcome::kNotVerified);
}

TEST(JudgeTasks, TasksInAWrapsFadingBandAreNamed) {
  Findings f;
  f.wraps = {"task 1: triceps_long is in a band", "task 2: biceps_long is in a band"};
  EXPECT_EQ(f.row(Check::kWraps).outcome, Outcome::kCare);
  EXPECT_THAT(says(f.row(Check::kWraps)), HasSubstr("triceps_long is in a band, the first of 2"));
}

TEST(JudgeTasks, ReservesThatCarryTooMuchAreNamedWithTheirTask) {
  Findings f;
  f.tasks[1].reserve_share = 0.12;
  f.tasks[2].reserve_share = 0.5;  // held out: nothing is estimated from it
  EXPECT_EQ(f.row(Check::kReserves).outcome, Outcome::kCare);
  EXPECT_EQ(f.row(Check::kReserves).value, 0.12);
  EXPECT_THAT(says(f.row(Check::kReserves)), HasSubstr("(task 2)"));
}

TEST(JudgeTasks, TasksThatHardlyMoveOrCannotFinishAreNamed) {
  Findings f;
  f.tasks[0].before.moves = false;
  f.tasks[1].estimated = {};
  f.unused = {"task 9: cannot be followed"};
  EXPECT_EQ(f.row(Check::kTasks).outcome, Outcome::kPassed);
  for (const Check check : {Check::kStillTasks, Check::kUnfinishedTasks, Check::kUnusedTasks}) {
    EXPECT_EQ(f.row(check).outcome, Outcome::kCare) << to_string(check);
    EXPECT_EQ(f.row(check).value, 1.0) << to_string(check);
  }
  EXPECT_THAT(says(f.row(Check::kStillTasks)), HasSubstr("task 1"));
  EXPECT_THAT(says(f.row(Check::kUnusedTasks)), HasSubstr("task 9"));
}

TEST(JudgeTasks, AResidualBeyondOrFarBelowTheNoiseIsSaidSo) {
  Findings f;
  f.estimate.chi_square = 4.0;
  EXPECT_EQ(f.row(Check::kTaskResidual).outcome, Outcome::kFailed);
  EXPECT_EQ(f.row(Check::kTaskResidual).cause, Cause::kMissingTerm);
  f.estimate.chi_square = 1.45;
  EXPECT_EQ(f.row(Check::kTaskResidual).outcome, Outcome::kCare);
  f.estimate.chi_square = 0.25;
  EXPECT_EQ(f.row(Check::kTaskResidual).outcome, Outcome::kCare);
  EXPECT_EQ(f.row(Check::kTaskResidual).cause, Cause::kNoise);
  f.estimate.chi_square = 1.0;
  f.estimate.lag1 = 0.8;
  EXPECT_EQ(f.row(Check::kResidualCorrelation).outcome, Outcome::kCare);
}

TEST(JudgeTasks, UnseenTasksAreMeasuredAgainstNoiseAndStandardModel) {
  Findings f;
  TaskOutcome& unseen = f.tasks[2];
  unseen.after.rmse = unseen.after.nrmse = 0.05;
  EXPECT_EQ(f.row(Check::kUnseenTasks).outcome, Outcome::kCare);
  unseen.after.rmse = unseen.after.nrmse = 0.2;
  EXPECT_EQ(f.row(Check::kUnseenTasks).outcome, Outcome::kFailed);
  EXPECT_EQ(f.row(Check::kBetterThanStandard).outcome, Outcome::kFailed);
  EXPECT_TRUE(f.row(Check::kBetterThanStandard).bears_on.contains(estimation::Purpose::kParameters));
  unseen.after.rmse = unseen.after.nrmse = kNaN;
  EXPECT_EQ(f.row(Check::kUnseenTasks).outcome, Outcome::kFailed);
  EXPECT_EQ(f.row(Check::kUnseenTasks).cause, Cause::kMissing);
  f.tasks.pop_back();
  EXPECT_EQ(f.row(Check::kUnseenTasks).outcome, Outcome::kMissing);
}

}  // namespace
}  // namespace veridyn::muscle
