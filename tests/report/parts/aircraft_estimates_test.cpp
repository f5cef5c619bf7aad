#include "veridyn/report/parts/aircraft_estimates.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/flight_by_hand.hpp"
#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using aircraft::FlightAnalysis;
using testing::ElementsAre;
using testing::HasSubstr;

FlightAnalysis pitch_and_drag() {
  FlightAnalysis analysis;
  analysis.coefficients = {test::pitch_by_hand(), test::drag_by_hand()};
  return analysis;
}

TEST(Identified, NeedsAnEstimateAndTheVerdict) {
  aircraft::CoefficientResult r = test::pitch_by_hand();
  EXPECT_TRUE(identified(r));
  r.verdict = estimation::GroupVerdict::kEffective;
  EXPECT_FALSE(identified(r));
  r = test::pitch_by_hand();
  r.chosen.reset();
  EXPECT_FALSE(identified(r));
}

TEST(CoefficientsSection, HasTheVerdictOfEachAndDashesWhereThereIsNoEstimate) {
  const Section section = coefficients_section(pitch_and_drag());
  const Table table = test::table_of(section.blocks, "Verdict per coefficient");
  check({.sections = {section}});
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_THAT(test::shown_row(table, 0),
              ElementsAre("Cm pitching moment", "identified", "GTLS", "98.0", "97.1", "0.031", "1.25"));
  EXPECT_EQ(table.rows[0].status, Status::kIdentified);
  EXPECT_THAT(test::shown_row(table, 1), ElementsAre("CD drag", "skipped", "", "–", "–", "–", "–"));
  EXPECT_THAT(test::texts_of(section.blocks), ElementsAre("Cm explains 97 % of the hold-out"));
}

TEST(CoefficientsSection, ShowsNoHoldOutWhereNothingWasHeldOut) {
  FlightAnalysis analysis = pitch_and_drag();
  analysis.coefficients[0].holdout_fit = {};
  const Table table = test::table_of(coefficients_section(analysis).blocks, "Verdict per coefficient");
  EXPECT_EQ(test::shown_in(table, table.rows[0], "hold-out", "explained"), "–");
  EXPECT_EQ(test::shown_in(table, table.rows[0], "identification", "explained"), "98.0");
}

TEST(OtherEstimatorsSection, MarksWhatContradictsTheRecommendedEstimate) {
  FlightAnalysis analysis = pitch_and_drag();
  const estimation::Parameter elsewhere{.name = "Cm_alpha", .value = -0.9, .sigma = 0.02, .unit = "1/rad"};
  analysis.others.parameters = {{.coefficient = aircraft::Coefficient::kCm,
                                 .estimate = {"output error", elsewhere},
                                 .normalised_difference = -7.2},
                                {.coefficient = aircraft::Coefficient::kCm,
                                 .estimate = {"frequency domain", elsewhere},
                                 .normalised_difference = 2.9}};
  analysis.others.notes = {"output error: 3 iterations"};
  const Section section = other_estimators_section(analysis);
  check({.sections = {section}});
  const Table table = test::table_of(section.blocks, "Comparison");
  ASSERT_EQ(table.rows.size(), 4U) << "two parameters, and two others of the first";
  EXPECT_EQ(test::shown_in(table, table.rows[0], "Method"), "GTLS");
  EXPECT_EQ(test::shown_in(table, table.rows[0], "Value"), "−0.731");
  EXPECT_EQ(test::shown_in(table, table.rows[0], "95 % low", "interval"), "−0.755");
  EXPECT_EQ(test::shown_in(table, table.rows[1], "Method"), "output error");
  EXPECT_EQ(test::shown_in(table, table.rows[1], "Apart"), "−7.2");
  EXPECT_EQ(table.rows[1].status, Status::kCaution);
  EXPECT_EQ(table.rows[2].status, Status::kNone) << "below three sigma";
  EXPECT_THAT(test::texts_of(section.blocks), testing::Contains("output error: 3 iterations"));
  EXPECT_TRUE(other_estimators_section(pitch_and_drag()).blocks.empty()) << "none was asked for";
}

TEST(OtherEstimatorsSection, ShowsTheOutputsOfOutputErrorWhereItCameOut) {
  FlightAnalysis analysis = pitch_and_drag();
  analysis.others.notes = {"note"};
  aircraft::AxisOutputError run;
  run.attempted = true;
  run.estimate.outputs = {
      {.name = "q", .unit = "rad/s", .fit = {.r2 = 0.95, .theil = 0.1}, .noise_sd = 0.01, .lag1 = 0.4}};
  analysis.others.output_error = {run};
  EXPECT_EQ(test::blocks_of<Table>(other_estimators_section(analysis).blocks).size(), 1U) << "not usable";
  analysis.others.output_error[0].estimate.termination = estimation::OutputErrorTermination::kConverged;
  const Section section = other_estimators_section(analysis);
  check({.sections = {section}});
  const Table table = test::table_of(section.blocks, "Output error, longitudinal: outputs");
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("q", "0.0100", "rad/s", "0.950", "0.100", "0.400"));
}

TEST(StructureSection, TellsTheStoryOfTheTerms) {
  FlightAnalysis analysis = pitch_and_drag();
  EXPECT_TRUE(structure_section(analysis).blocks.empty());
  estimation::StructureSearch search;
  search.text = "two terms of ten";
  estimation::StructureStep start, refused;
  start.terms = 1;
  start.F = 5.0;
  refused.action = estimation::StructureAction::kRefuse;
  refused.term = "alpha^2";
  refused.terms = 2;
  refused.F = 12.3;
  refused.r2_change = 0.4;
  refused.reason = "F below 20";
  search.history = {start, refused};
  analysis.coefficients[0].structure = search;
  const Section section = structure_section(analysis);
  check({.sections = {section}});
  const Table table = test::table_of(section.blocks, "Cm: history");
  EXPECT_EQ(table.caption, "two terms of ten");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(test::shown_in(table, table.rows[0], "F"), "–") << "no term, no partial F";
  EXPECT_EQ(test::shown_in(table, table.rows[1], "F"), "12.3");
  EXPECT_EQ(test::shown_in(table, table.rows[1], "Change"), "40.0");
  EXPECT_EQ(test::shown_in(table, table.rows[1], "Why not"), "F below 20");
}

TEST(UncertaintySection, ShowsTheErrorBySource) {
  aircraft::UncertaintyReport report;
  report.text = "100000 draws";
  report.coefficients = {{.coefficient = aircraft::Coefficient::kCL,
                          .error = {.low = -0.021, .high = 0.019, .sigma = 0.0113, .mean = 0.0001},
                          .sigma_linear = 0.0102,
                          .sigma_sensors = 0.008,
                          .sigma_body = 0.0063,
                          .range = 0.25}};
  const Section section = uncertainty_section(report);
  check({.sections = {section}});
  const Table table = test::table_of(section.blocks, "Error of one measured coefficient");
  EXPECT_THAT(test::shown_row(table, 0),
              ElementsAre("CL", "0.011", "−0.021", "0.019", "0.00010", "0.010", "0.008", "0.006", "0.250"));
  EXPECT_THAT(test::texts_of(section.blocks), ElementsAre("100000 draws."));
}

}  // namespace
}  // namespace veridyn::report
