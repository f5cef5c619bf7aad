#include "veridyn/estimation/judgement/judgement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::estimation {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A row that says `about` and no more.
Evidence row(Outcome outcome, Purposes bears_on, std::string about = "") {
  return Evidence{.check = Check::kSignAgainstOthers,
                  .about = std::move(about),
                  .outcome = outcome,
                  .value = 0.0,
                  .bears_on = bears_on}
      .with("reference", std::string("gyro"));
}

/// What such a row says.
std::string said(std::string about) { return says(row(Outcome::kCare, {}, std::move(about))); }

TEST(Purposes, AreASet) {
  const Purposes two = Purpose::kData | Purpose::kPrediction;
  EXPECT_TRUE(two.contains(Purpose::kData));
  EXPECT_FALSE(two.contains(Purpose::kParameters));
  EXPECT_TRUE(two.contains(Purpose::kPrediction));
  EXPECT_FALSE(two.empty());
  EXPECT_TRUE(Purposes().empty());
}

TEST(Judge, TakesTheWorstRowThatBearsOnAPurpose) {
  const std::vector<Evidence> rows{
      row(Outcome::kPassed, kAllPurposes, "fine"), row(Outcome::kCare, Purpose::kParameters, "so-so"),
      row(Outcome::kFailed, Purpose::kPrediction, "bad"), row(Outcome::kCare, Purpose::kPrediction, "not the reason")};
  const Judgement judgement = judge(rows);
  EXPECT_EQ(judgement.data.grade, Grade::kYes);
  EXPECT_THAT(judgement.data.decided_by, IsEmpty());
  EXPECT_EQ(judgement.parameters.grade, Grade::kWithCare);
  EXPECT_THAT(judgement.parameters.decided_by, ElementsAre(said("so-so")));
  EXPECT_EQ(judgement.prediction.grade, Grade::kNo);
  EXPECT_THAT(judgement.prediction.decided_by, ElementsAre(said("bad")));
}

TEST(Judge, DoesNotJudgeWithoutARowOrWithoutWhatWouldDecide) {
  EXPECT_EQ(judge({}).data.grade, Grade::kNotJudged);
  const std::vector<Evidence> rows{row(Outcome::kNotVerified, Purpose::kData, "unknown"),
                                   row(Outcome::kPassed, Purpose::kPrediction),
                                   row(Outcome::kMissing, Purpose::kPrediction, "no hold-out")};
  EXPECT_EQ(judge(rows).data.grade, Grade::kNotJudged) << "what cannot be verified is no judgement";
  EXPECT_EQ(judge(rows).prediction.grade, Grade::kNotJudged);
  EXPECT_THAT(judge(rows).prediction.decided_by, ElementsAre(said("no hold-out")));
}

TEST(Judge, DoesNotLowerAGradeByWhatCannotBeVerified) {
  const std::vector<Evidence> rows{row(Outcome::kPassed, Purpose::kData), row(Outcome::kNotVerified, Purpose::kData)};
  EXPECT_EQ(judge(rows).data.grade, Grade::kYes);
}

Judgement parameters(Grade grade, std::string why) { return {.parameters = {grade, {std::move(why)}}}; }

TEST(JudgeTogether, IsWithCareWherePartsDiffer) {
  const std::vector<Judgement> parts{parameters(Grade::kYes, "a"), parameters(Grade::kNo, "b")};
  const Judgement together = judge_together(parts);
  EXPECT_EQ(together.parameters.grade, Grade::kWithCare);
  EXPECT_THAT(together.parameters.decided_by, ElementsAre("a", "b"));
  EXPECT_EQ(judge_together(std::vector{parameters(Grade::kNo, "b"), parameters(Grade::kNo, "b")}).parameters.grade,
            Grade::kNo);
  EXPECT_EQ(judge_together({}).parameters.grade, Grade::kNotJudged);
}

TEST(Worse, PrefersTheLowerGradeAndAnyToNone) {
  const PurposeGrade none, care{Grade::kWithCare, {"x"}}, no{Grade::kNo, {"y"}};
  EXPECT_EQ(worse(none, care).grade, Grade::kWithCare);
  EXPECT_EQ(worse(care, none).grade, Grade::kWithCare);
  EXPECT_EQ(worse(care, no).grade, Grade::kNo);
  EXPECT_EQ(worse(no, care).grade, Grade::kNo);
}

TEST(SentenceOf, SaysAllThree) {
  EXPECT_EQ(sentence_of({.data = {Grade::kYes, {}}, .parameters = {Grade::kWithCare, {}}, .prediction = {}}),
            "The recording agrees with itself and with physics; the parameters may be used with care; prediction was "
            "not judged.");
}

}  // namespace
}  // namespace veridyn::estimation
