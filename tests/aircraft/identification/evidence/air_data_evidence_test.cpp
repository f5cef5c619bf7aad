#include "veridyn/aircraft/identification/evidence/air_data_evidence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/aircraft/circling_flight.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Outcome;

TEST(DoubtOf, IsTheMeasurementsWhereThatIsGoodAndThePriorsWhereItIsNot) {
  EXPECT_NEAR(doubt_of(Determined{1.03, 0.001}, 1.0, 0.1), 0.03, 1e-4);
  EXPECT_NEAR(doubt_of(Determined{1.0, 0.001}, 1.0, 0.1), 0.001, 1e-6);
  EXPECT_NEAR(doubt_of(Determined{3.0, 100.0}, 1.0, 0.1), 0.1, 1e-4);
  EXPECT_EQ(doubt_of(std::nullopt, 1.0, 0.1), 0.1);
  EXPECT_EQ(doubt_of(Determined{kNaN, kNaN}, 0.0, 0.05), 0.05);
  // Posterior of a normal prior: mean 0.05, variance 0.005.
  EXPECT_NEAR(doubt_of(Determined{1.1, 0.1}, 1.0, 0.1), std::sqrt(0.05 * 0.05 + 0.005), 1e-12);
}

/// The doubts of a flight of 150 s with a channel scaled.
std::vector<FlightEvidence> evidence_with(const char* channel, double factor, const char* turbulence) {
  FlightStudy study = aircraft::testing::campaign_flight("unatrap", 1, 150.0, turbulence);
  Channel changed = study.mapped.recording.at(channel);
  for (double& v : changed.value) v *= factor;
  study.mapped.recording.set(std::move(changed));
  return aircraft::testing::identified(study).analysis.flights.front().recording_evidence;
}

double doubt_about(const std::vector<FlightEvidence>& rows, FlightSignal signal) {
  double largest = 0.0;
  for (const FlightEvidence& row : rows)
    if (row.doubt && row.doubt->signal == signal) largest = std::max(largest, row.doubt->scale);
  return largest;
}

TEST(AirDataEvidence, LeavesLittleInDoubtInCalmAirAndMoreInTurbulence) {
  const std::vector<FlightEvidence> calm = evidence_with("alpha", 1.0, "none");
  const std::vector<FlightEvidence> rough = evidence_with("alpha", 1.0, "low_moderate");
  for (const FlightSignal signal : {FlightSignal::kAirspeed, FlightSignal::kAlpha, FlightSignal::kBeta}) {
    EXPECT_LT(doubt_about(calm, signal), 0.05) << kFlightSignalNames[signal];
    EXPECT_GT(doubt_about(rough, signal), doubt_about(calm, signal));
  }
}

// A dynamic pressure of 1.2 times is within what headings in turbulence leave of the airspeed's scale. In calm air it
// is named.
TEST(AirDataEvidence, DoubtsAWrongScaleThatItCannotName) {
  const auto row_of = [](const std::vector<FlightEvidence>& rows) {
    return std::ranges::find_if(rows, [](const FlightEvidence& e) { return e.row.about == "airspeed" && e.doubt; });
  };
  const std::vector<FlightEvidence> calm = evidence_with("dynamic_pressure", 1.2, "none");
  ASSERT_NE(row_of(calm), calm.end());
  EXPECT_EQ(row_of(calm)->row.outcome, Outcome::kCare);
  const std::vector<FlightEvidence> rough = evidence_with("dynamic_pressure", 1.2, "low_moderate");
  ASSERT_NE(row_of(rough), rough.end());
  EXPECT_GT(row_of(rough)->doubt->scale, 0.02);
}

/// The row of a name of five circles; `taken_off` is what the reconstruction found of an error, with its name.
FlightEvidence circling_row(const std::string& name, const aircraft::testing::Circles& circles,
                            const std::pair<const char*, double>& taken_off = {"none", 0.0}) {
  const Recording recording = aircraft::testing::circling(circles);
  Reconstruction reconstruction;
  Channel density = recording.at("air_density");
  Channel error = make_channel(taken_off.first, "1", density.time, std::vector(density.size(), taken_off.second));
  reconstruction.smoothed.add(std::move(density));
  reconstruction.smoothed.add(std::move(error));
  Segments segments;
  segments.airborne = {{0.0, aircraft::testing::kCirclingEnd_s}};
  for (FlightEvidence& row : air_data_evidence(recording, reconstruction, true, segments))
    if (row.row.name == name) return std::move(row);
  throw std::logic_error("no row " + name);
}

// In calm air the headings determine the scale to a fraction of a per cent.
TEST(AirDataEvidence, GradesTheScaleOfTheAirspeed) {
  const auto row = [](double scale) {
    return circling_row("airspeed against ground velocity", {.scale = scale, .gust = 0.05}).row;
  };
  EXPECT_EQ(row(1.0).outcome, Outcome::kPassed) << row(1.0).text;
  EXPECT_EQ(row(1.05).outcome, Outcome::kCare) << row(1.05).text;
  EXPECT_EQ(row(0.8).outcome, Outcome::kFailed) << row(0.8).text;
  EXPECT_THAT(row(1.9438).text, ::testing::HasSubstr("knots taken for m/s"));
  EXPECT_FALSE(row(0.8).advice.empty());
  // What the reconstruction found of the pitot tube, in pressure, is not held against it.
  EXPECT_EQ(
      circling_row("airspeed against ground velocity", {.scale = std::sqrt(1.2), .gust = 0.05}, {"pitot_scale", 0.2})
          .row.outcome,
      Outcome::kPassed);
}

TEST(AirDataEvidence, SaysHowWellGustsLetTheScaleBeVerified) {
  const FlightEvidence gusty = circling_row("airspeed against ground velocity", {.gust = 1.5});
  EXPECT_EQ(gusty.row.outcome, Outcome::kNotVerified) << gusty.row.text;
  EXPECT_THAT(gusty.row.text, ::testing::HasSubstr("verified to no better than"));
  EXPECT_GT(gusty.doubt.value().scale, 0.01);
}

TEST(AirDataEvidence, GradesTheZeroOfAVane) {
  const auto row = [](double bias, double taken_off = 0.0) {
    return circling_row("alpha vane against inertial angle", {.alpha_bias = bias, .gust = 0.05},
                        {"alpha_bias", taken_off});
  };
  EXPECT_EQ(row(0.0).row.outcome, Outcome::kNotVerified) << row(0.0).row.text;
  EXPECT_EQ(row(3.0 * kDegree).row.outcome, Outcome::kCare) << row(3.0 * kDegree).row.text;
  EXPECT_NEAR(row(3.0 * kDegree).row.value, 3.0, 0.2);
  EXPECT_EQ(row(8.0 * kDegree).row.outcome, Outcome::kFailed);
  EXPECT_EQ(row(3.0 * kDegree, 3.0 * kDegree).row.outcome, Outcome::kNotVerified) << "found and taken off";
  EXPECT_THAT(row(2.0).row.text, ::testing::HasSubstr("over 90 deg is no flow angle"));
  EXPECT_FALSE(row(0.0).bears_on(Coefficient::kCn));
}

// Without gyro and accelerometer nothing is compared, which is no alarm.
TEST(AirDataEvidence, SaysThatTheScaleOfAVaneIsNotVerified) {
  for (const char* name : {"scale of the alpha vane", "scale of the beta vane"}) {
    const FlightEvidence row = circling_row(name, {});
    EXPECT_EQ(row.row.outcome, Outcome::kNotVerified);
    EXPECT_NEAR(row.doubt.value().scale, 0.2, 1e-12) << "what is left is the prior";
  }
}

}  // namespace
}  // namespace veridyn::aircraft
