#include "veridyn/report/parts/aircraft_flights.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/flight_by_hand.hpp"
#include "tests/report/shown.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Two flights, the second held out.
aircraft::FlightAnalysis two_flights() {
  aircraft::FlightAnalysis analysis;
  for (const char* name : {"monday.csv", "friday.csv"}) {
    aircraft::PreparedFlight& flight = analysis.flights.emplace_back();
    flight.name = name;
    flight.aligned.log_kind = "standard names";
    flight.aligned.recording.add(make_channel("gyro_x", "rad/s", make_time_base({5.0, 105.0}), {0.0, 0.0}));
    flight.segments.longitudinal.excited = {{10.0, 40.0}};
  }
  analysis.flights[0].segments.longitudinal.identification = {{10.0, 40.0}};
  analysis.flights[1].segments.longitudinal.holdout = {{10.0, 40.0}};
  analysis.flights[1].shift_s = 110.0;
  analysis.estimate.recordings = {
      {.name = "monday.csv", .use = "identification"},
      {.name = "friday.csv", .use = "hold-out", .validation = {{"Cm", {0.001, 0.002, 0.91, 0.1, "1"}}}}};
  return analysis;
}

TEST(FlightsSection, SaysWhichRecordingEachManoeuvreCameFrom) {
  const Section section = flights_section(two_flights());
  check({.sections = {section}});
  const Table recordings = test::table_of(section.blocks, "Recordings");
  EXPECT_THAT(test::shown_row(recordings, 1),
              ElementsAre("friday.csv", "standard names", "hold-out", "100", "30", "0", "115"));
  const Table manoeuvres = test::table_of(section.blocks, "Manoeuvres");
  ASSERT_EQ(manoeuvres.rows.size(), 2U);
  EXPECT_THAT(test::shown_row(manoeuvres, 1), ElementsAre("friday.csv", "longitudinal", "hold-out", "10.0", "40.0"));
  const Table scores = test::table_of(section.blocks, "Prediction, recording by recording");
  EXPECT_THAT(test::shown_row(scores, 0), ElementsAre("friday.csv", "Cm", "0.00200", "1", "0.910"));
}

TEST(FlightsSection, ShowsWhatEachFlightSaysOfTheParameters) {
  aircraft::FlightAnalysis analysis = two_flights();
  aircraft::CoefficientResult cm = test::pitch_by_hand();
  cm.scatter.emplace();
  cm.scatter->between_sigma = Eigen::Vector2d(0.5, 0.25);
  cm.flight_estimates = {{"monday.csv", cm.chosen->parameters}};
  analysis.coefficients = {cm};
  const Section section = flights_section(analysis);
  check({.sections = {section}});
  const Table table = test::table_of(section.blocks, "Cm, flight by flight");
  ASSERT_EQ(table.rows.size(), 4U);
  EXPECT_EQ(test::shown_in(table, table.rows[0], "Recording"), "all");
  EXPECT_EQ(test::shown_in(table, table.rows[0], "Between flights"), "0.50");
  EXPECT_EQ(test::shown_in(table, table.rows[1], "Recording"), "monday.csv");
}

TEST(FlightsSection, IsEmptyForOneRecording) {
  aircraft::FlightAnalysis analysis = two_flights();
  analysis.flights.pop_back();
  EXPECT_TRUE(flights_section(analysis).blocks.empty());
}

}  // namespace
}  // namespace veridyn::report
