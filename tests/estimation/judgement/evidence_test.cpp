#include "veridyn/estimation/judgement/evidence.hpp"

#include <gtest/gtest.h>

namespace veridyn::estimation {
namespace {

TEST(OutcomeOf, CountsOnlyWhatExceedsThreeStandardErrors) {
  constexpr Tolerance kScale = Tolerance::about(1.0, 0.02, 0.15);
  EXPECT_EQ(outcome_of(1.01, 0.0, kScale), Outcome::kPassed);
  EXPECT_EQ(outcome_of(1.05, 0.0, kScale), Outcome::kCare);
  EXPECT_EQ(outcome_of(1.05, 0.011, kScale), Outcome::kPassed);
  EXPECT_EQ(outcome_of(0.8, 0.01, kScale), Outcome::kFailed);
  EXPECT_EQ(outcome_of(0.8, 0.02, kScale), Outcome::kCare);
  EXPECT_EQ(outcome_of(-1.0, 0.01, kScale), Outcome::kFailed);
}

TEST(OutcomeOf, LimitsNeedNotBeSymmetric) {
  constexpr Tolerance kRatio{.low = 4.0, .high = 40.0, .lowest = 1.0, .highest = 120.0};
  EXPECT_EQ(outcome_of(3.0, 0.1, kRatio), Outcome::kCare);
  EXPECT_EQ(outcome_of(0.5, 0.1, kRatio), Outcome::kFailed);
  EXPECT_EQ(outcome_of(60.0, 1.0, kRatio), Outcome::kCare);
  EXPECT_EQ(outcome_of(130.0, 1.0, kRatio), Outcome::kFailed);
  EXPECT_EQ(outcome_of(45.0, 2.0, kRatio), Outcome::kPassed);
}

TEST(OutcomeBetween, PassesWhereAnyOfTheRangeDoes) {
  constexpr Tolerance kScale = Tolerance::about(1.0, 0.02, 0.15);
  EXPECT_EQ(outcome_between(0.7, 1.5, kScale), Outcome::kPassed);
  EXPECT_EQ(outcome_between(1.05, 1.5, kScale), Outcome::kCare);
  EXPECT_EQ(outcome_between(1.2, 1.5, kScale), Outcome::kFailed);
}

}  // namespace
}  // namespace veridyn::estimation
