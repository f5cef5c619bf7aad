#include "veridyn/estimation/result/analysis.hpp"

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
  const std::vector<Parameter> parameters{
      {.name = "a", .value = 1.0, .low95 = 0.9, .high95 = 1.1, .status = ParameterStatus::kIdentified},
      {.name = "b", .status = ParameterStatus::kFixed},
      {.name = "c", .status = ParameterStatus::kNotExcited}};
  const auto effective = marked(parameters, GroupVerdict::kEffective);
  EXPECT_EQ(effective[0].status, ParameterStatus::kEffective);
  EXPECT_EQ(effective[1].status, ParameterStatus::kFixed);
  EXPECT_EQ(effective[2].status, ParameterStatus::kNotExcited);
  EXPECT_EQ(marked(parameters, GroupVerdict::kRejected)[0].status, ParameterStatus::kRejected);
  EXPECT_EQ(marked(parameters, GroupVerdict::kIdentified)[0].status, ParameterStatus::kIdentified);
}

TEST(Marked, CallsWhatHasAWideIntervalWeak) {
  // Half the width over the value: 0.4 and 0.6; the limit is 0.5.
  std::vector<Parameter> parameters{
      {.name = "a", .value = -1.0, .low95 = -1.4, .high95 = -0.6, .status = ParameterStatus::kIdentified},
      {.name = "b", .value = -1.0, .low95 = -1.6, .high95 = -0.4, .status = ParameterStatus::kIdentified},
      {.name = "c", .value = 1.0, .low95 = -1.0, .high95 = 3.0, .status = ParameterStatus::kInsignificant}};
  const auto of_identified = marked(parameters, GroupVerdict::kIdentified);
  EXPECT_EQ(of_identified[0].status, ParameterStatus::kIdentified);
  EXPECT_EQ(of_identified[1].status, ParameterStatus::kWeak);
  EXPECT_EQ(of_identified[2].status, ParameterStatus::kInsignificant);
  EXPECT_EQ(marked(parameters, GroupVerdict::kEffective)[1].status, ParameterStatus::kEffective);
}

TEST(Marked, SaysWhichParameterARowObjectsTo) {
  const std::vector<Parameter> parameters{{.name = "mu", .status = ParameterStatus::kIdentified},
                                          {.name = "C_f", .status = ParameterStatus::kIdentified},
                                          {.name = "C_r", .status = ParameterStatus::kNotExcited}};
  const std::vector<Evidence> rows{{.about = "mu", .outcome = Outcome::kCare},
                                   {.about = "C_f", .outcome = Outcome::kPassed},
                                   {.about = "C_r", .outcome = Outcome::kFailed}};
  const auto found = marked(parameters, rows, ParameterStatus::kImplausible);
  EXPECT_EQ(found[0].status, ParameterStatus::kImplausible);
  EXPECT_EQ(found[1].status, ParameterStatus::kIdentified);
  EXPECT_EQ(found[2].status, ParameterStatus::kNotExcited);
  // What is known to be implausible stays so where the group predicts, and is rejected with it.
  EXPECT_EQ(marked(found, GroupVerdict::kEffective)[0].status, ParameterStatus::kImplausible);
  EXPECT_EQ(marked(found, GroupVerdict::kEffective)[1].status, ParameterStatus::kEffective);
  EXPECT_EQ(marked(found, GroupVerdict::kRejected)[0].status, ParameterStatus::kRejected);
}

// Neither the chosen method's own parameters, without what is not known of the body, nor those of one that failed.
TEST(EstimateOf, HasAGroupWithWhatOtherMethodsGave) {
  const ParameterGroup group{.name = "car",
                             .verdict = GroupVerdict::kEffective,
                             .reason = "predicts only",
                             .parameters = {{.name = "C_f", .value = 5.0}},
                             .method = "output error",
                             .methods = {{"OLS", true, "", {{.name = "C_f", .value = 4.0}}},
                                         {"TLS", false, "", {{.name = "C_f", .value = 9.0}}},
                                         {"output error", true, "", {{.name = "C_f", .value = 5.0}}}},
                             .evidence = {{.about = "C_f", .outcome = Outcome::kCare}},
                             .judgement = {.prediction = {.grade = Grade::kWithCare}}};
  const std::vector<PredictedQuantity> predictions{
      {.name = "yaw_rate", .unit = "rad/s", .fit = {.rmse = 0.1, .r2 = 0.9}}};
  const Estimate estimate = estimate_of(group, Eigen::MatrixXd::Constant(1, 1, 0.25), predictions);
  EXPECT_EQ(estimate.subject, "car");
  EXPECT_EQ(estimate.method, "output error");
  EXPECT_EQ(estimate.verdict, "predicts only");
  ASSERT_EQ(estimate.parameters.size(), 1u);
  EXPECT_EQ(estimate.covariance(0, 0), 0.25);
  ASSERT_EQ(estimate.other_methods.size(), 1u);
  EXPECT_EQ(estimate.other_methods[0].method, "OLS");
  EXPECT_EQ(estimate.other_methods[0].parameter.value, 4.0);
  EXPECT_EQ(estimate.validation.at("yaw_rate").r2, 0.9);
  EXPECT_EQ(estimate.validation.at("yaw_rate").unit, "rad/s");
  ASSERT_EQ(estimate.evidence.size(), 1u);
  EXPECT_EQ(estimate.judgement.prediction.grade, Grade::kWithCare);
}

}  // namespace
}  // namespace veridyn::estimation
