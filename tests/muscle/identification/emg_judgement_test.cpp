#include "veridyn/muscle/identification/emg_judgement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/identification/moved_arm.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using ::testing::HasSubstr;

/// A moment that goes up and down, of which the standard model and the estimate predict these multiples.
TaskOutcome outcome_of(double standard, double estimated, bool hold_out = false) {
  TaskOutcome t;
  t.name = "trial";
  t.hold_out = hold_out;
  t.measured.resize(50, 1);
  for (Eigen::Index k = 0; k < 50; ++k) {
    t.time.push_back(0.1 * static_cast<double>(k));
    t.measured(k, 0) = 4.0 + 3.0 * std::sin(0.4 * static_cast<double>(k));
  }
  t.standard = standard * t.measured;
  t.estimated = estimated * t.measured;
  return t;
}

class JudgedEmg : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<Evidence> rows(const std::vector<TaskOutcome>& tasks, const EmgError& error = {}) const {
    return judge_emg({.model = model,
                      .system = arm().system,
                      .theta = theta,
                      .tasks = tasks,
                      .error = error,
                      .error_factors = factors,
                      .outputs = outputs});
  }
  static const test::MovedArm& arm() {
    static const test::MovedArm moved(load_model("arm").model(), PathSource::kFitted, {"brachialis.excitation_gain"},
                                      {{MuscleOutputKind::kMoment, 1, 0.0}});
    return moved;
  }
  std::vector<MuscleOutput> outputs{{MuscleOutputKind::kMoment, 1, 0.0}};
  EmgDrivenModel model = arm().along(10, 1e-6);
  Eigen::VectorXd theta = Eigen::VectorXd::Constant(1, 1.0);
  Eigen::VectorXd factors = Eigen::VectorXd::Constant(3, 0.6);
};

TEST_F(JudgedEmg, PassesWhereMomentsAndEmgBelongTogether) {
  const std::vector<Evidence> all = rows({outcome_of(2.0, 1.0)});
  ASSERT_EQ(all.size(), 5U);
  for (const Evidence& row : all) EXPECT_EQ(row.outcome, Outcome::kPassed) << says(row);
  EXPECT_NEAR(all[0].value, 1.0, 1e-12) << "correlated";
  EXPECT_NEAR(all[1].value, 1.0, 1e-12) << "all is explained";
  EXPECT_NEAR(all[3].value, 0.1, 1e-12) << "as stated";
  EXPECT_NEAR(all[4].value, 0.6 * std::sqrt(3.0), 1e-12) << "as found, of all parts";
}

TEST_F(JudgedEmg, FailsWhereTheMomentsHaveTheOtherSign) {
  const Evidence row = rows({outcome_of(-1.0, 1.0)})[0];
  EXPECT_EQ(row.outcome, Outcome::kFailed);
  EXPECT_NEAR(row.value, -1.0, 1e-12);
  EXPECT_EQ(row.cause, estimation::Cause::kSign);
  for (const estimation::Purpose p : estimation::kPurposes) EXPECT_TRUE(row.bears_on.contains(p));
}

TEST_F(JudgedEmg, CannotTellTheSignOfMomentsThatDoNotChange) {
  TaskOutcome still = outcome_of(1.0, 1.0);
  still.measured.setConstant(2.0);
  EXPECT_EQ(rows({still})[0].outcome, Outcome::kNotVerified);
  outputs[0].kind = MuscleOutputKind::kTendonForce;
  EXPECT_EQ(rows({outcome_of(-1.0, 1.0)})[0].outcome, Outcome::kNotVerified) << "no moment was measured";
}

// An estimate of a times the moment y leaves (1 - a)^2 of its mean square; of its variance, with a mean of 4 and an
// amplitude of 3, that is more.
TEST_F(JudgedEmg, CautionsWhereTheEmgExplainsLittle) {
  const TaskOutcome t = outcome_of(1.0, 0.5);
  const double mean = t.measured.mean(), square = t.measured.array().square().sum(),
               variance = (t.measured.array() - mean).square().sum();
  const Evidence row = rows({t})[1];
  EXPECT_NEAR(row.value, 1.0 - 0.25 * square / variance, 1e-12);
  EXPECT_EQ(row.outcome, Outcome::kCare);
}

TEST_F(JudgedEmg, LooksAtTrainedTasksThatWereSimulated) {
  TaskOutcome unfinished = outcome_of(-1.0, -1.0);
  unfinished.standard.resize(0, 0);
  unfinished.estimated.resize(0, 0);
  for (const Evidence& row : rows({outcome_of(1.0, 1.0), outcome_of(-1.0, -1.0, true), unfinished}))
    EXPECT_EQ(row.outcome, Outcome::kPassed) << says(row);
}

// The brachialis' EMG goes from 0.02 to 0.22: beyond a gain of 1/0.22 it is cut off.
TEST_F(JudgedEmg, CautionsWhereExcitationsStandAtTheirLimit) {
  EXPECT_EQ(rows({outcome_of(1.0, 1.0)})[2].value, 0.0);
  theta(0) = 9.0;
  const Evidence row = rows({outcome_of(1.0, 1.0)})[2];
  EXPECT_EQ(row.outcome, Outcome::kCare);
  EXPECT_GT(row.value, 0.05);
  EXPECT_LT(row.value, 1.0);
  EXPECT_EQ(row.cause, estimation::Cause::kSaturation);
  EXPECT_THAT(says(row), HasSubstr("(brachialis in trial)"));
}

TEST_F(JudgedEmg, FailsWhereTheEmgWouldHaveToBeMuchMoreWrongThanStated) {
  factors(2) = 1.7;
  EXPECT_EQ(rows({outcome_of(1.0, 1.0)})[4].outcome, Outcome::kCare);
  factors(2) = 2.6;
  const Evidence row = rows({outcome_of(1.0, 1.0)})[4];
  EXPECT_EQ(row.outcome, Outcome::kFailed);
  EXPECT_EQ(row.cause, estimation::Cause::kMissingTerm);
  EXPECT_TRUE(row.bears_on.contains(estimation::Purpose::kParameters));
  EXPECT_THAT(says(row), HasSubstr("the model does not fit"));
}

TEST_F(JudgedEmg, CautionsWhereTheEmgIsTakenAsExact) {
  const Evidence row = rows({outcome_of(1.0, 1.0)}, {.relative = 0.0, .absolute = 0.0})[3];
  EXPECT_EQ(row.outcome, Outcome::kCare);
  EXPECT_THAT(advice_of(row), HasSubstr("emg.noise"));
}

}  // namespace
}  // namespace veridyn::muscle
