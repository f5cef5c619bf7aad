#include "veridyn/report/parts/aircraft_sensors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using aircraft::Observability;
using aircraft::PreparedFlight;
using testing::ElementsAre;

std::vector<std::string> table_titles(const Section& section) {
  std::vector<std::string> titles;
  for (const Table& table : test::blocks_of<Table>(section.blocks)) titles.push_back(table.title);
  return titles;
}

TEST(SensorsSection, LeavesOutWhatThisFlightDoesNotHave) {
  const Section section = sensors_section({});
  check({.sections = {section}});
  EXPECT_THAT(table_titles(section), ElementsAre("Channels", "Innovations", "What the sensors determine"));
  EXPECT_EQ(test::fact_of(test::blocks_of<FactList>(section.blocks).at(0).facts, "Guard"), "");
}

TEST(SensorsSection, SaysWhereEachChannelIsFromAndByHowMuchItIsLate) {
  PreparedFlight flight;
  flight.aligned.origins.resize(1);
  flight.aligned.origins[0].channel = "airspeed";
  flight.aligned.origins[0].source = "ARSP.Airspeed";
  flight.aligned.origins[0].rate_Hz = 10.0;
  flight.aligned.origins[0].note = "zero taken off";
  flight.delays = {{.group = "attitude",
                    .reference = "gyro",
                    .delay_s = 0.0204,
                    .sigma_s = 0.001,
                    .correlation = 0.98,
                    .finding = recording::DelayFinding::kApplied}};
  const Section section = sensors_section(flight);
  check({.sections = {section}});
  const Table channels = test::table_of(section.blocks, "Channels");
  EXPECT_THAT(test::shown_row(channels, 0), ElementsAre("airspeed", "ARSP.Airspeed", "10.0", "zero taken off"));
  const Table delays = test::table_of(section.blocks, "Delays");
  EXPECT_THAT(test::shown_row(delays, 0), ElementsAre("attitude", "gyro", "20.4", "1.0", "0.98", "applied"));
}

TEST(SensorsSection, ShowsAnglesInDegrees) {
  PreparedFlight flight;
  aircraft::Reconstruction& rec = flight.reconstruction;
  rec.sensors = {{.channel = "alpha",
                  .unit = "rad",
                  .sigma = 0.5 * kDegree,
                  .rate_Hz = 50.0,
                  .innovations = {.count = 1000,
                                  .rejected = 7,
                                  .nis = 1.5,
                                  .mean_size = -0.01 * kDegree,
                                  .rms_size = 0.6 * kDegree,
                                  .expected_size = 0.49 * kDegree,
                                  .lag1 = 0.1}}};
  rec.quantities = {{.quantity = "beta",
                     .unit = "rad",
                     .prior_sigma = 4.0 * kDegree,
                     .sigma = 1.0 * kDegree,
                     .observability = Observability::kWeak,
                     .statement = "beta is weak"}};
  const Section section = sensors_section(flight);
  check({.sections = {section}});
  const Table innovations = test::table_of(section.blocks, "Innovations");
  EXPECT_THAT(test::shown_row(innovations, 0),
              ElementsAre("alpha", "0.500", "−0.010", "0.600", "0.490", "deg", "1000", "7", "1.50", "0.10"));
  const Table quantities = test::table_of(section.blocks, "What the sensors determine");
  EXPECT_THAT(test::shown_row(quantities, 0),
              ElementsAre("beta", "1.00", "4.00", "deg", "weakly observable", "beta is weak"));
  EXPECT_EQ(quantities.rows[0].cells[4].status, Status::kCaution);
}

TEST(SensorsSection, DrawsInnovationsOverWhatWasExpected) {
  PreparedFlight flight;
  aircraft::Reconstruction& rec = flight.reconstruction;
  rec.sensors.resize(2);
  rec.sensors[0].channel = "alpha";
  rec.sensors[0].unit = "rad";
  rec.sensors[1].channel = "vel_north";
  EXPECT_TRUE(test::blocks_of<TimeSeries>(sensors_section(flight).blocks).empty()) << "not kept";
  const TimeBase time = make_time_base({0.0, 0.1, 0.2, 0.3});
  rec.innovations.add(make_channel("alpha", "rad", time, {0.0, kDegree, -20.0 * kDegree, 0.0}));
  rec.innovations.add(make_channel("sigma_alpha", "rad", time, {50.0 * kDegree, kDegree, kDegree, kDegree}));
  rec.innovations.add(make_channel("refused_alpha", "1", time, {0.0, 0.0, 1.0, 0.0}));
  const Section section = sensors_section(flight);
  check({.sections = {section}});
  const std::vector<TimeSeries> figures = test::blocks_of<TimeSeries>(section.blocks);
  ASSERT_EQ(figures.size(), 1U);
  ASSERT_EQ(figures[0].panels.size(), 1U);
  const Panel& panel = figures[0].panels[0];
  EXPECT_EQ(panel.unit, "deg");
  ASSERT_EQ(panel.lines.size(), 4U);
  EXPECT_NEAR(panel.lines[0].y.at(2), -20.0, 1e-9);
  EXPECT_TRUE(std::isnan(panel.lines[1].y.at(0))) << "before anything is known";
  EXPECT_NEAR(panel.lines[1].y.at(1), 1.96, 0.001);
  EXPECT_NEAR(panel.lines[2].y.at(1), -1.96, 0.001);
  EXPECT_EQ(panel.lines[3].x, (std::vector<double>{0.2}));
  EXPECT_NEAR(panel.lines[3].y.at(0), -20.0, 1e-9);
}

TEST(SensorsSection, SaysHowMuchOfASensorsErrorTheFlightDetermines) {
  PreparedFlight flight;
  aircraft::SensorErrorReport bias, scale;
  bias.name = "alpha_bias";
  bias.unit = "rad";
  bias.value = -1.0 * kDegree;
  bias.prior_sigma = 2.0 * kDegree;
  bias.sigma = 0.5 * kDegree;
  bias.information = 0.9375;
  bias.correlation = -0.97;
  bias.correlated_with = "accel_bias_z";
  bias.observability = Observability::kObservable;
  scale.name = "pitot_scale";
  scale.unit = "1";
  flight.reconstruction.sensor_errors = {bias, scale};
  const Section section = sensors_section(flight);
  check({.sections = {section}});
  const Table table = test::table_of(section.blocks, "Errors of the sensors and of the model");
  EXPECT_THAT(test::shown_row(table, 0),
              ElementsAre("alpha_bias", "−1.00", "0.50", "2.00", "deg", "93.8", "accel_bias_z", "−0.97", "observable"));
  EXPECT_EQ(test::shown_in(table, table.rows[1], "Unit"), "");
  EXPECT_EQ(table.rows[1].cells.back().status, Status::kBad);
}

TEST(SensorsSection, ComparesFiltersOnlyWhereThereAreNumbers) {
  PreparedFlight flight;
  aircraft::FilterError e;
  e.quantity = "alpha";
  e.unit = "rad";
  e.signal_sd = 2.0 * kDegree;
  e.model_free.filter_rms = 0.8 * kDegree;
  e.model_free.smoother_rms = 0.4 * kDegree;
  e.model_based.filter_rms = 0.6 * kDegree;
  e.model_based.smoother_rms = 0.2 * kDegree;
  flight.reconstruction.comparison = {e};
  const Section section = sensors_section(flight);
  check({.sections = {section}});
  const Table table = test::table_of(section.blocks, "Model-free against model-based filter");
  // Shares of the variance: (0.4 / 2)^2 and (0.2 / 2)^2. There is no bound.
  EXPECT_THAT(test::shown_row(table, 0),
              ElementsAre("alpha", "deg", "0.800", "0.400", "0.600", "0.200", "–", "–", "4.00", "1.00"));
}

}  // namespace
}  // namespace veridyn::report
