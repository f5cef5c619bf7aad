#include "veridyn/report/ground_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using aircraft::InertiaVerdict;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A run that swings with 2 rad/s and 10 deg at first, of which the second half was fitted.
aircraft::SwingRun swing_by_hand(const std::string& file) {
  aircraft::SwingRun run;
  run.file = file;
  for (int k = 0; k < 100; ++k) {
    run.swing.time.push_back(0.1 * k);
    run.swing.angle.push_back(10.0 * kDegree * std::cos(0.2 * k));
  }
  run.swing.principal_share = 0.995;
  run.begin = 50;
  run.end = 100;
  run.fit.end = estimation::DampedCosineEnd::kFitted;
  run.fit.damped_frequency = 2.0;
  run.fit.cosine = 10.0 * kDegree;
  run.fit.duration = 5.0;
  run.fit.residual_rms = 0.1 * kDegree;
  return run;
}

aircraft::AxisInertia inertia_by_hand(char axis, InertiaVerdict verdict) {
  aircraft::AxisInertia i;
  i.test.axis = axis;
  i.runs = {swing_by_hand(std::string(1, axis) + "_1.csv")};
  i.value = 0.4231;
  i.error.low = -0.02;
  i.error.high = 0.03;
  i.error.sd = 0.0123;
  i.by_length = 0.011;
  i.largest_term = 1.5;
  i.verdict = verdict;
  i.reason = std::string("J") + axis + " is so";
  return i;
}

aircraft::SwingTest test_by_hand() {
  aircraft::SwingTest t;
  t.name = "Thor <1>";
  t.mass = 2.47;
  t.cradle_mass = 1.042;
  return t;
}

TEST(SwingTestReport, SaysWhichMomentsAreDetermined) {
  const auto report_of = [](std::vector<InertiaVerdict> verdicts) {
    aircraft::SwingTestResult result;
    char axis = 'x';
    for (const InertiaVerdict v : verdicts) result.axes.push_back(inertia_by_hand(axis++, v));
    result.estimate.verdict = "a verdict";
    const Document document = swing_test_report(test_by_hand(), result, "veridyn test");
    check(document);
    return document;
  };
  const auto good = InertiaVerdict::kDetermined, bad = InertiaVerdict::kNotDetermined;
  EXPECT_EQ(report_of({good, good}).verdict.level, Level::kGood);
  EXPECT_EQ(report_of({bad}).verdict.word, "Not determined");
  EXPECT_EQ(report_of({bad}).verdict.level, Level::kBad);
  const Document partly = report_of({good, bad});
  EXPECT_EQ(partly.verdict.level, Level::kCaution);
  EXPECT_EQ(partly.verdict.headline, "a verdict.");
  EXPECT_THAT(partly.verdict.lines, ElementsAre("Jx is so", "Jy is so"));
  EXPECT_EQ(partly.title, "Thor <1>: inertia from swing tests");
  EXPECT_EQ(test::fact_of(partly.facts, "Mass"), "2.47 kg");
  EXPECT_EQ(test::fact_of(partly.facts, "Standard errors"), "2 g, 2 mm between the lines, 5 mm of lengths");
  EXPECT_THAT(test::titles_of(partly), Not(Contains("Warnings")));
}

// The error is that of the value: the truth lies between value - high and value - low.
TEST(SwingTestReport, TurnsTheErrorsIntoAnInterval) {
  aircraft::SwingTestResult result;
  result.axes = {inertia_by_hand('z', InertiaVerdict::kDetermined)};
  result.warnings = {"short runs"};
  const Document document = swing_test_report(test_by_hand(), result, "veridyn test");
  const Table table = test::table_of(test::section_of(document, "Moments of inertia").blocks, "Moments of inertia");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_THAT(test::shown_row(table, 0),
              ElementsAre("Jz", "determined", "0.423", "0.012", "0.393", "0.443", "0", "0", "0.011", "0", "1.50"));
  EXPECT_THAT(test::texts_of(test::section_of(document, "Warnings").blocks), ElementsAre("short runs"));
}

TEST(SwingTestReport, ShowsEachRunWithItsFitWhereItWasFitted) {
  aircraft::SwingTestResult result;
  result.axes = {inertia_by_hand('x', InertiaVerdict::kDetermined)};
  result.axes[0].runs.push_back(swing_by_hand("x_2.csv"));
  result.axes[0].runs[1].cradle_alone = true;
  result.axes[0].runs[1].fit.end = estimation::DampedCosineEnd::kNoOscillation;
  const Document document = swing_test_report(test_by_hand(), result, "veridyn test");
  check(document);
  const Section& runs = test::section_of(document, "Runs");
  const Table table = test::table_of(runs.blocks, "Runs");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(test::shown_in(table, table.rows[0], "Undamped frequency"), "2.0000");
  EXPECT_EQ(test::shown_in(table, table.rows[0], "Amplitude"), "10.0");
  EXPECT_EQ(test::shown_in(table, table.rows[0], "Main axis"), "99.5");
  EXPECT_EQ(test::shown_in(table, table.rows[1], "What hung"), "cradle alone");
  EXPECT_EQ(test::shown_in(table, table.rows[1], "Result"), "no oscillation");
  EXPECT_EQ(table.rows[1].status, Status::kBad);
  const std::vector<TimeSeries> figures = test::blocks_of<TimeSeries>(runs.blocks);
  ASSERT_EQ(figures.size(), 2U);
  const Line& fit = figures[0].panels[0].lines[1];
  EXPECT_TRUE(std::isnan(fit.y[49]));
  EXPECT_NEAR(fit.y[50], 10.0 * std::cos(2.0 * 5.0), 1e-9) << "in degrees";
  for (const double y : figures[1].panels[0].lines[1].y) EXPECT_TRUE(std::isnan(y)) << "no fit";
}

/// A vane with five points up and down, in radians.
aircraft::SensorFit vane_by_hand() {
  aircraft::SensorFit fit;
  fit.calibration.channel = "alpha";
  fit.calibration.scale = 1.25;
  fit.calibration.bias = 2.0 * kDegree;
  fit.calibration.covariance << 1e-4, 0.0, 0.0, std::pow(0.1 * kDegree, 2);
  fit.unit = "rad";
  for (const double deg : {-10.0, 0.0, 10.0, 5.0, -5.0}) {
    fit.reference.push_back(deg * kDegree);
    fit.raw.push_back((2.0 + 1.25 * deg) * kDegree);
    fit.residual.push_back(0.2 * kDegree);
    fit.direction.push_back(fit.reference.size() <= 3 ? 1 : -1);
  }
  fit.rms = 0.2 * kDegree;
  fit.worst = 0.3 * kDegree;
  fit.hysteresis = kNaN;
  fit.usable = true;
  return fit;
}

TEST(CalibrationReport, ShowsAVaneInDegrees) {
  aircraft::CalibrationStudy study;
  study.name = "boom";
  study.file = "data/tunnel.csv";
  aircraft::CalibrationResult result;
  result.sensors = {vane_by_hand()};
  const Document document = calibration_report(study, result, "veridyn test");
  check(document);
  EXPECT_EQ(document.verdict.word, "Calibrated");
  EXPECT_EQ(test::fact_of(document.facts, "Points"), "tunnel.csv");
  const Table table = test::table_of(test::section_of(document, "Calibration").blocks, "Scale and bias");
  ASSERT_EQ(table.rows.size(), 1U);
  const Row& row = table.rows[0];
  EXPECT_EQ(test::shown_in(table, row, "value", "scale"), "1.250");
  EXPECT_EQ(test::shown_in(table, row, "sigma", "scale"), "0.010");
  EXPECT_EQ(test::shown_in(table, row, "value", "bias"), "2.00");
  EXPECT_EQ(test::shown_in(table, row, "sigma", "bias"), "0.10");
  EXPECT_EQ(test::shown_in(table, row, "rms", "residual"), "0.200");
  EXPECT_EQ(test::shown_in(table, row, "Hysteresis"), "–") << "points of one way only";
  EXPECT_EQ(test::shown_in(table, row, "Unit"), "deg");
  EXPECT_EQ(row.status, Status::kGood);
}

TEST(CalibrationReport, DrawsTheLineFromTheLowestToTheHighestReference) {
  aircraft::CalibrationResult result;
  result.sensors = {vane_by_hand()};
  const Document document = calibration_report({}, result, "veridyn test");
  const std::vector<XYPlot> plots = test::blocks_of<XYPlot>(test::section_of(document, "Points").blocks);
  ASSERT_EQ(plots.size(), 2U);
  const XYSeries& line = plots[0].series[1];
  EXPECT_NEAR(line.x[0], -10.0, 1e-9);
  EXPECT_NEAR(line.x[1], 10.0, 1e-9);
  EXPECT_NEAR(line.y[1], 2.0 + 1.25 * 10.0, 1e-9) << "the readings are on it";
  ASSERT_EQ(plots[1].series.size(), 2U);
  EXPECT_EQ(plots[1].series[0].x.size(), 3U) << "rising";
  EXPECT_EQ(plots[1].series[1].name, "falling");
}

TEST(CalibrationReport, MarksWhatFailedAndWhatIsNoStraightLine) {
  aircraft::CalibrationResult result;
  result.sensors = {vane_by_hand(), vane_by_hand()};
  result.sensors[0].findings = {"it bends"};
  result.estimate.warnings = {"alpha: it bends"};
  const Document reserved = calibration_report({}, result, "veridyn test");
  EXPECT_EQ(reserved.verdict.word, "With reservations");
  EXPECT_THAT(reserved.verdict.lines, ElementsAre(HasSubstr("it bends")));
  const Table table = test::table_of(test::section_of(reserved, "Calibration").blocks, "Scale and bias");
  EXPECT_EQ(table.rows[0].status, Status::kCaution);
  EXPECT_EQ(table.rows[1].status, Status::kGood);
  result.sensors[1].usable = false;
  EXPECT_EQ(calibration_report({}, result, "veridyn test").verdict.level, Level::kBad);
}

}  // namespace
}  // namespace veridyn::report
