#include "veridyn/report/parts/analysis_sections.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::report {
namespace {

using estimation::Analysis;
using estimation::GroupVerdict;
using estimation::Parameter;
using estimation::ParameterGroup;
using estimation::ParameterStatus;

Parameter stiffness(double value) {
  return {
      .name = "C_f", .value = value, .sigma = 0.01 * value, .unit = "N/rad", .status = ParameterStatus::kIdentified};
}

Analysis analysis_with(GroupVerdict verdict) {
  Analysis analysis;
  analysis.groups = {
      {.name = "car",
       .verdict = verdict,
       .reason = "a reason",
       .parameters = {stiffness(5e4), {.name = "bias", .value = 0.1, .unit = "rad"}},
       .method = "output error",
       .methods = {{.method = "OLS", .usable = true, .parameters = {stiffness(4e4)}},
                   {.method = "TLS", .usable = false, .message = "no solution"},
                   {.method = "output error",
                    .usable = true,
                    .parameters = {stiffness(5e4), {.name = "bias", .value = 0.1, .unit = "rad"}}}},
       .evidence = {estimation::row_of(estimation::Check::kDeflections, "", estimation::Outcome::kFailed)}}};
  return analysis;
}

template <typename Kind>
std::vector<Kind> blocks(const Section& section) {
  std::vector<Kind> found;
  for (const Block& block : section.blocks) {
    if (const auto* kind = std::get_if<Kind>(&block)) found.push_back(*kind);
  }
  return found;
}

TEST(ParametersSection, ShowsTheChosenMethodInUnitsForReading) {
  const auto tables = blocks<Table>(parameters_section(analysis_with(GroupVerdict::kIdentified), ""));
  ASSERT_EQ(tables.size(), 1U);
  ASSERT_EQ(tables[0].rows.size(), 2U);
  EXPECT_DOUBLE_EQ(*tables[0].rows[0].cells[1].number, 5e4);
  EXPECT_NEAR(*tables[0].rows[1].cells[1].number, 0.1 / kDegree, 1e-12);
  EXPECT_EQ(tables[0].rows[0].cells.size(), tables[0].columns.size());
}

TEST(ParametersSection, ShowsFrequenciesInHertz) {
  Analysis analysis = analysis_with(GroupVerdict::kIdentified);
  analysis.groups[0].parameters = {{.name = "roll_frequency", .value = 4.0 * kPi, .unit = "rad/s"},
                                   {.name = "yaw_rate_bias", .value = kPi, .unit = "rad/s"}};
  const auto tables = blocks<Table>(parameters_section(analysis, ""));
  ASSERT_EQ(tables.size(), 1U);
  ASSERT_EQ(tables[0].rows.size(), 2U);
  EXPECT_DOUBLE_EQ(*tables[0].rows[0].cells[1].number, 2.0);
  EXPECT_DOUBLE_EQ(*tables[0].rows[1].cells[1].number, 180.0);
}

TEST(ParametersSection, ShowsTheTruthOnlyWhereItIsKnown) {
  Analysis analysis = analysis_with(GroupVerdict::kIdentified);
  analysis.truth["C_f"] = 5.1e4;
  const auto tables = blocks<Table>(parameters_section(analysis, ""));
  ASSERT_EQ(tables.size(), 1U);
  EXPECT_EQ(tables[0].columns.back().name, "truth");
  EXPECT_DOUBLE_EQ(*tables[0].rows[0].cells.back().number, 5.1e4);
  EXPECT_EQ(tables[0].rows[0].cells.size(), tables[0].columns.size());
}

// Shares of the variance: 3^2, 4^2 and 1^2 of 26, of which the last is below a twentieth.
TEST(ParametersSection, SaysWhatAnIntervalConsistsOf) {
  Analysis analysis = analysis_with(GroupVerdict::kIdentified);
  analysis.estimate.interval_parts["C_f"] = {
      {"by_noise", "noise", 3.0}, {"by_delays", "delays", 4.0}, {"by_body", "mass", 1.0}};
  const auto tables = blocks<Table>(parameters_section(analysis, ""));
  ASSERT_EQ(tables.size(), 1U);
  EXPECT_EQ(tables[0].columns.back().name, "interval by");
  EXPECT_EQ(tables[0].rows[0].cells.back().text, "delays 62\u00a0%, noise 35\u00a0%");
  EXPECT_EQ(tables[0].rows[1].cells.back().text, "");
  EXPECT_EQ(tables[0].rows[1].cells.size(), tables[0].columns.size());
}

TEST(ParametersSection, KeepsRejectedValuesOutOfTheTable) {
  const Analysis rejected = analysis_with(GroupVerdict::kRejected);
  EXPECT_TRUE(blocks<Table>(parameters_section(rejected, "")).empty());
  EXPECT_TRUE(methods_section(rejected).blocks.empty());
  EXPECT_EQ(blocks<IntervalPlot>(rejected_section(rejected)).size(), 1U);
  EXPECT_TRUE(rejected_section(analysis_with(GroupVerdict::kIdentified)).blocks.empty());
}

TEST(MethodsSection, ComparesWhatSeveralMethodsEstimatedAndSaysWhyOneGaveNothing) {
  const Section section = methods_section(analysis_with(GroupVerdict::kIdentified));
  const auto plots = blocks<IntervalPlot>(section);
  ASSERT_EQ(plots.size(), 1U);
  EXPECT_THAT(plots[0].methods, testing::ElementsAre("OLS", "output error"));
  ASSERT_EQ(plots[0].rows.size(), 1U);  // the bias is of one method only
  EXPECT_EQ(plots[0].rows[0].name, "C_f");
  const auto texts = blocks<Paragraph>(section);
  ASSERT_EQ(texts.size(), 1U);
  EXPECT_EQ(texts[0].text, "car, TLS: no solution");
}

estimation::Estimate judged_estimate(estimation::Outcome outcome) {
  estimation::Estimate estimate;
  estimate.evidence = {estimation::row_of(estimation::Check::kHeldSamples, "gps", outcome)
                           .with("channel", std::string("gps"))
                           .with("rate_Hz", 1.0)};
  estimate.evidence.front().value = 5.0;
  estimate.judgement = estimation::judge(estimate.evidence);
  return estimate;
}

TEST(VerdictOf, SaysWhatDecidedAndWhatToDo) {
  using estimation::Outcome;
  EXPECT_EQ(verdict_of(judged_estimate(Outcome::kPassed)).level, Level::kGood);
  EXPECT_THAT(verdict_of(judged_estimate(Outcome::kPassed)).lines, testing::IsEmpty());
  const Verdict care = verdict_of(judged_estimate(Outcome::kCare));
  EXPECT_EQ(care.level, Level::kCaution);
  EXPECT_THAT(care.lines,
              testing::ElementsAre("gps is measured at 1 Hz and held: 5 samples in a row are one measurement",
                                   "What to do: give the recording with the sensor's own stamps, one a "
                                   "measurement"));
  EXPECT_EQ(verdict_of(judged_estimate(Outcome::kFailed)).level, Level::kBad);
}

TEST(EvidenceSection, HasWhatFailedFirstAndEachSentenceOnce) {
  using estimation::Outcome;
  Analysis analysis = analysis_with(GroupVerdict::kIdentified);
  EXPECT_TRUE(evidence_section(analysis.estimate).blocks.empty());
  analysis.estimate = judged_estimate(Outcome::kPassed);
  for (const Outcome outcome : {Outcome::kCare, Outcome::kFailed, Outcome::kCare, Outcome::kNotVerified})
    analysis.estimate.evidence.push_back(judged_estimate(outcome).evidence.front());
  analysis.estimate.evidence[3].bears_on = {};
  const Section section = evidence_section(analysis.estimate);
  EXPECT_EQ(section.inside, "1 failed, 1 with care, 1 not verified, 1 for information, 1 passed");
  const auto tables = blocks<Table>(section);
  ASSERT_EQ(tables.size(), 5U);
  EXPECT_EQ(tables[0].title, "1 of 5 failed");
  for (const Table& table : tables) {
    ASSERT_EQ(table.rows.size(), 1U);
    EXPECT_EQ(table.rows[0].cells.size(), table.columns.size());
  }
  EXPECT_EQ(tables[0].rows[0].cells[4].text, "see the top of this page");
  EXPECT_THAT(tables[4].rows[0].cells[4].text, testing::HasSubstr("gps"));
}

TEST(PredictionTable, HasARowForEachQuantity) {
  const std::vector<estimation::PredictedQuantity> quantities{
      {.name = "yaw_rate", .unit = "rad/s", .fit = {.mae = 0.1}}};
  const Table table = prediction_table(quantities, "Prediction");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_NEAR(*table.rows[0].cells[1].number, 0.1 / kDegree, 1e-12);
  EXPECT_EQ(table.rows[0].cells.size(), table.columns.size());
}

}  // namespace
}  // namespace veridyn::report
