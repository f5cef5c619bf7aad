#include "veridyn/estimation/analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::estimation {
namespace {

TEST(MethodResult, FindsItsParametersByName) {
  const MethodResult gtls{.method = "GTLS", .usable = true, .parameters = {{.name = "Cm_alpha", .value = -0.5}}};
  ASSERT_NE(gtls.find("Cm_alpha"), nullptr);
  EXPECT_DOUBLE_EQ(gtls.find("Cm_alpha")->value, -0.5);
  EXPECT_EQ(gtls.find("Cm_q"), nullptr);
}

TEST(Analysis, KnowsTheTruthOfSimulatedRecordingsOnly) {
  Analysis analysis;
  EXPECT_TRUE(std::isnan(analysis.true_value("C_f")));
  analysis.truth["C_f"] = 5e4;
  EXPECT_DOUBLE_EQ(analysis.true_value("C_f"), 5e4);
}

TEST(VerdictOf, IsEffectiveWhereOnlyThePredictionMayBeUsed) {
  Judgement judgement;
  judgement.parameters.grade = Grade::kWithCare;
  EXPECT_EQ(verdict_of(judgement), GroupVerdict::kIdentified);
  judgement.parameters.grade = Grade::kNo;
  judgement.prediction.grade = Grade::kYes;
  EXPECT_EQ(verdict_of(judgement), GroupVerdict::kEffective);
  judgement.prediction.grade = Grade::kNotJudged;
  EXPECT_EQ(verdict_of(judgement), GroupVerdict::kRejected);
  EXPECT_TRUE(usable(GroupVerdict::kEffective));
  EXPECT_FALSE(usable(GroupVerdict::kRejected));
}

TEST(Marked, LeavesWhatIsFixedOrNotExcited) {
  const std::vector<Parameter> parameters{{.name = "a", .status = ParameterStatus::kIdentified},
                                          {.name = "b", .status = ParameterStatus::kFixed},
                                          {.name = "c", .status = ParameterStatus::kNotExcited}};
  const auto effective = marked(parameters, GroupVerdict::kEffective);
  EXPECT_EQ(effective[0].status, ParameterStatus::kEffective);
  EXPECT_EQ(effective[1].status, ParameterStatus::kFixed);
  EXPECT_EQ(effective[2].status, ParameterStatus::kNotExcited);
  EXPECT_EQ(marked(parameters, GroupVerdict::kRejected)[0].status, ParameterStatus::kRejected);
  EXPECT_EQ(marked(parameters, GroupVerdict::kIdentified)[0].status, ParameterStatus::kIdentified);
}

}  // namespace
}  // namespace veridyn::estimation
