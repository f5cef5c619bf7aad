#include "bench/reproduction/report/aircraft_reproduction_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// One parameter of Cn by OLS, whose value was published, and by GTLS, published as TLS.
aircraft::Reproduction batch_by_hand() {
  using Values = Eigen::VectorXd;
  aircraft::Reproduction r;
  r.title = "Cn, exact regressors";
  r.finding = "OLS is biased";
  r.conditions = "as strong a noise as in flight";
  r.options.flight.subject.name = "Thor";
  r.options.flight.duration = 60.0;
  r.options.coefficient = aircraft::Coefficient::kCn;
  r.options.seeds = 20;
  r.options.snr_dB = 30.0;
  r.published["OLS"]["Cn_beta"] = 0.08;
  r.published["TLS"]["Cn_beta"] = 0.1;
  aircraft::BatchExperiment batch;
  batch.rows.names = {"Cn_beta"};
  batch.rows.time = {0.0, 1.0};
  batch.rows.regressand = Eigen::Vector2d(0.02, -0.04);
  batch.rows.truth = Values::Constant(1, 0.1);
  batch.methods = {{.method = estimation::Method::kOls,
                    .estimates = 20,
                    .mean = Values::Constant(1, 0.081),
                    .sd = Values::Constant(1, 0.002),
                    .mean_sigma = Values::Constant(1, 0.002),
                    .coverage = Values::Constant(1, 0.05),
                    .output_error = {},
                    .example = {0.016, -0.032}},
                   {.method = estimation::Method::kGtls,
                    .estimates = 20,
                    .mean = Values::Constant(1, 0.1005),
                    .sd = Values::Constant(1, 0.002),
                    .mean_sigma = Values::Constant(1, 0.002),
                    .coverage = Values::Constant(1, 0.95),
                    .output_error = {},
                    .example = {}}};
  r.batch = batch;
  r.checks = {{.passed = true, .text = "biased: OLS"}};
  return r;
}

TEST(AircraftReproduction, PutsPublishedAndOwnEstimatesSideBySide) {
  const ReproducedRow row = reproduced_row(batch_by_hand());
  EXPECT_TRUE(row.passed());
  EXPECT_THAT(row.ours, HasSubstr("Thor flown for 60 s, 50 rows a second, noise of z 30 dB below its variance, "
                                  "regressors exact, 20 seeds."));
  EXPECT_THAT(row.ours, HasSubstr(" OLS: Cn_beta 0.081 +- 0.002 (published 0.08, true 0.1)."));
  EXPECT_THAT(row.ours, HasSubstr(" GTLS: Cn_beta 0.1005 +- 0.002 (published 0.1, true 0.1).")) << "published as TLS";
  EXPECT_THAT(row.ours, HasSubstr(" as strong a noise as in flight."));
  const Table table = test::table_of(row.blocks, "Parameters");
  check({.sections = {{.blocks = row.blocks}}});
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(test::shown_in(table, table.rows[0], "mean", "OLS"), "0.0810");
  EXPECT_EQ(test::shown_in(table, table.rows[0], "bias", "OLS"), "9.50") << "0.019 in scatters of 0.002";
  EXPECT_EQ(test::shown_in(table, table.rows[0], "covered", "GTLS"), "95.0");
}

TEST(AircraftReproduction, SaysNothingOfAMethodOfWhichNothingWasPublished) {
  aircraft::Reproduction r = batch_by_hand();
  r.published.erase("TLS");
  const ReproducedRow row = reproduced_row(r);
  EXPECT_THAT(row.ours, Not(HasSubstr("GTLS")));
  const Table table = test::table_of(row.blocks, "Parameters");
  EXPECT_EQ(test::shown_in(table, table.rows[0], "published", "GTLS"), "–");
}

TEST(AircraftReproduction, DrawsTheErrorAsAShareOfTheLargestTruth) {
  const ReproducedRow row = reproduced_row(batch_by_hand());
  const TimeSeries figure = test::blocks_of<TimeSeries>(row.blocks).at(0);
  ASSERT_THAT(test::labels_of(figure), ElementsAre("Cn", "error"));
  EXPECT_THAT(test::lines_of(figure.panels[0]), ElementsAre("truth", "OLS")) << "GTLS has no example";
  EXPECT_NEAR(figure.panels[1].lines[0].y[1], 20.0, 1e-9) << "0.008 of 0.04";
}

TEST(AircraftReproduction, DescribesTheNoise) {
  aircraft::Reproduction r = batch_by_hand();
  r.options.regressor_snr_dB = 20.0;
  r.options.noise_time_s = 0.3;
  EXPECT_THAT(reproduced_row(r).ours, HasSubstr("of each regressor 20 dB below its own, correlated over 0.3 s"));
}

/// Two repetitions of a tracker over a flight whose parameter changes at 10 s.
aircraft::Reproduction tracking_by_hand() {
  aircraft::Reproduction r = batch_by_hand();
  r.batch.reset();
  r.options.seeds = 2;
  aircraft::TrackingExperiment e;
  e.rows.names = {"Cn_beta"};
  e.rows.time = {0.0, 10.0, 20.0};
  e.rows.truth = Eigen::VectorXd::Constant(1, 0.1);
  e.rows.truth_at = Eigen::Vector3d(0.1, 0.2, 0.2);
  e.phase_s = {0.0, 10.0};
  e.phase_text = {"", "Cn_beta"};
  e.trackers = {{.name = "variable", .options = {}}};
  aircraft::TrackingRun first;
  first.settling_s = {2.0, kNaN};
  first.changes = {{}, {}};
  first.triggers = 3;
  first.history.time = {0.0, 10.0, 20.0};
  first.history.value = {{50.0, 0.11, 0.19}};
  first.history.sigma = {{kInfinity, 0.01, 0.01}};
  first.history.excited = {0, 1, 1};
  first.history.threshold = {1.0, 1.0, 1.0};
  first.history.lambda = first.history.suspicion = {0.9, 0.9, 0.9};
  aircraft::TrackingRun second = first;
  second.settling_s = {4.0, 1.5};
  e.runs = {{first, second}};
  r.tracking = e;
  return r;
}

TEST(AircraftReproduction, SaysOfATrackerWhenItSettledAndThatItNeverDid) {
  const ReproducedRow row = reproduced_row(tracking_by_hand());
  const Table table = test::table_of(row.blocks, "Trackers");
  check({.sections = {{.blocks = row.blocks}}});
  ASSERT_EQ(table.rows.size(), 1U);
  const Row& only = table.rows[0];
  EXPECT_EQ(test::shown_in(table, only, "slowest", "from the start"), "4.0");
  EXPECT_EQ(test::shown_in(table, only, "slowest", "change at 10 s"), "never");
  EXPECT_EQ(test::shown_in(table, only, "alarms"), "4") << "of both repetitions";
  EXPECT_EQ(test::shown_in(table, only, "forgetting triggered"), "6");
}

TEST(AircraftReproduction, HidesWildValuesOfATrackerAndShadesWhereItIsExcited) {
  const ReproducedRow row = reproduced_row(tracking_by_hand());
  const TimeSeries figure = test::blocks_of<TimeSeries>(row.blocks).at(0);
  ASSERT_THAT(test::labels_of(figure), ElementsAre("Cn_beta", "lambda", "suspicion (1: alarm)"));
  const Line& line = figure.panels[0].lines[1];
  EXPECT_TRUE(std::isnan(line.y[0])) << "50 where the truth is 0.2 at most";
  EXPECT_EQ(line.y[1], 0.11);
  ASSERT_TRUE(line.band.has_value());
  EXPECT_NEAR(line.band->low[1], 0.11 - 0.01 * numerics::kNormal95, 1e-12);
  ASSERT_EQ(figure.spans.size(), 1U);
  EXPECT_EQ(figure.spans[0].from, 10.0);
  EXPECT_EQ(figure.spans[0].to, 20.0);
}

}  // namespace
}  // namespace veridyn::report
