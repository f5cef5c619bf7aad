#include "veridyn/report/parts/aircraft_evidence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/flight_by_hand.hpp"
#include "tests/report/shown.hpp"

namespace veridyn::report {
namespace {

using aircraft::FlightAnalysis;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

/// Cm with the singular values of a PCA-GTLS estimate.
FlightAnalysis excited_pitch() {
  FlightAnalysis analysis;
  aircraft::CoefficientResult r = test::pitch_by_hand();
  estimation::RegressionEstimate e;
  e.method = estimation::Method::kPcaGtls;
  e.rows = 512;
  e.threshold = 45.2;
  e.singular_values = {1234.0, 12.5};
  e.condition_number = 8.0;
  e.unexcited = {{.combination = {}, .bound95 = 0.0, .text = "0.71 Cm_q + 0.70 Cm_de"}};
  r.comparison.estimates = {e};
  analysis.coefficients = {r, test::drag_by_hand()};
  analysis.flights.emplace_back();
  analysis.flights.front().segments.longitudinal.text = "12 s are excited";
  analysis.flights.front().segments.lateral.text = "nothing is excited";
  return analysis;
}

TEST(ExcitationSection, NamesTheCombinationThatTheFlightDoesNotDetermine) {
  const Section section = excitation_section(excited_pitch());
  check({.sections = {section}});
  EXPECT_THAT(test::texts_of(section.blocks), ElementsAre("12 s are excited", "nothing is excited"));
  const Table table = test::table_of(section.blocks, "Excited directions");
  ASSERT_EQ(table.rows.size(), 1U) << "nothing was estimated of CD";
  EXPECT_THAT(test::shown_row(table, 0),
              ElementsAre("Cm", "512", "45.2", "1.23e+03, 12.5", "0.71 Cm_q + 0.70 Cm_de", "8.00"));
  FlightAnalysis all = excited_pitch();
  all.coefficients[0].comparison.estimates[0].unexcited.clear();
  const Table none = test::table_of(excitation_section(all).blocks, "Excited directions");
  EXPECT_EQ(test::shown_in(none, none.rows[0], "Not excited"), "none");
}

TEST(ExcitationSection, CorrelatesTheParametersOfWhatIsIdentifiedAlone) {
  FlightAnalysis analysis = excited_pitch();
  const std::vector<Matrix> matrices = test::blocks_of<Matrix>(excitation_section(analysis).blocks);
  ASSERT_EQ(matrices.size(), 1U);
  EXPECT_THAT(matrices[0].row_names, ElementsAre("Cm_alpha", "Cm_de"));
  // The covariance is [[4, 3], [3, 9]].
  EXPECT_DOUBLE_EQ(matrices[0].values[0][1], 0.5);
  EXPECT_DOUBLE_EQ(matrices[0].values[1][1], 1.0);
  analysis.coefficients[0].verdict = estimation::GroupVerdict::kRejected;
  EXPECT_THAT(test::blocks_of<Matrix>(excitation_section(analysis).blocks), IsEmpty());
}

TEST(ResidualSection, ShowsTheResidualsOfWhatWasEstimated) {
  FlightAnalysis analysis = excited_pitch();
  EXPECT_THAT(residual_section(analysis).blocks, IsEmpty()) << "no autocorrelation";
  aircraft::CoefficientResult& r = analysis.coefficients[0];
  r.residual_autocorrelation = {.value = {1.0, 0.2}, .white_bound95 = 0.1, .count = 500};
  r.row_interval_s = 0.1;
  const Section section = residual_section(analysis);
  check({.sections = {section}});
  const std::vector<XYPlot> plots = test::blocks_of<XYPlot>(section.blocks);
  ASSERT_EQ(plots.size(), 2U);
  EXPECT_NEAR(plots[0].series[0].x[1], 0.1, 1e-12) << "the lag in seconds";
  EXPECT_EQ(plots[0].series[0].y[1], 0.2);
  r.chosen.reset();
  EXPECT_THAT(residual_section(analysis).blocks, IsEmpty());
}

TEST(ValidationSection, SaysWhyNothingWasPredicted) {
  FlightAnalysis analysis;
  analysis.validation.text = "nothing was held out";
  const Section without = validation_section(analysis);
  ASSERT_EQ(without.blocks.size(), 1U);
  EXPECT_EQ(std::get<Paragraph>(without.blocks[0]).tone, Tone::kNote);
  analysis.validation.text = "6 windows of 5 s";
  analysis.validation.windows = 6;
  analysis.predictions = {{.name = "airspeed", .unit = "m/s", .fit = {.mae = 0.2, .rmse = 0.25, .count = 300}}};
  const Section with = validation_section(analysis);
  check({.sections = {with}});
  EXPECT_EQ(std::get<Paragraph>(with.blocks[0]).tone, Tone::kPlain);
  const Table table = test::table_of(with.blocks, "Prediction");
  EXPECT_THAT(test::shown_row(table, 0), Contains("0.250"));
}

}  // namespace
}  // namespace veridyn::report
