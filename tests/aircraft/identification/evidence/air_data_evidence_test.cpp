#include "veridyn/aircraft/identification/evidence/air_data_evidence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/aircraft/circling_flight.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
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
PreparedFlight evidence_with(const char* channel, double factor, const char* turbulence) {
  FlightStudy study = aircraft::testing::campaign_flight("unatrap", 1, 150.0, turbulence);
  Channel changed = study.mapped.recording.at(channel);
  for (double& v : changed.value) v *= factor;
  study.mapped.recording.set(std::move(changed));
  return aircraft::testing::identified(study).analysis.flights.front();
}

double doubt_about(const std::vector<SignalDoubt>& doubts, FlightSignal signal) {
  double largest = 0.0;
  for (const SignalDoubt& doubt : doubts)
    if (doubt.signal == signal) largest = std::max(largest, doubt.scale);
  return largest;
}

TEST(AirDataEvidence, LeavesLittleInDoubtInCalmAirAndMoreInTurbulence) {
  const std::vector<SignalDoubt> calm = evidence_with("alpha", 1.0, "none").doubts;
  const std::vector<SignalDoubt> rough = evidence_with("alpha", 1.0, "low_moderate").doubts;
  for (const FlightSignal signal : {FlightSignal::kAirspeed, FlightSignal::kAlpha, FlightSignal::kBeta}) {
    EXPECT_LT(doubt_about(calm, signal), 0.05) << kFlightSignalNames[signal];
    EXPECT_GT(doubt_about(rough, signal), doubt_about(calm, signal));
  }
}

// A dynamic pressure of 1.2 times is within what headings in turbulence leave of the airspeed's scale. In calm air it
// is named.
TEST(AirDataEvidence, DoubtsAWrongScaleThatItCannotName) {
  const PreparedFlight calm = evidence_with("dynamic_pressure", 1.2, "none");
  const auto row = std::ranges::find(calm.recording_evidence, Check::kAirspeedScale, &Evidence::check);
  ASSERT_NE(row, calm.recording_evidence.end());
  EXPECT_EQ(row->outcome, Outcome::kCare);
  const PreparedFlight rough = evidence_with("dynamic_pressure", 1.2, "low_moderate");
  EXPECT_GT(doubt_about(rough.doubts, FlightSignal::kAirspeed), 0.02);
}

/// The checks of five circles; `taken_off` is what the reconstruction found of an error, with its name.
CheckedFlight circled(const aircraft::testing::Circles& circles,
                      const std::pair<const char*, double>& taken_off = {"none", 0.0}) {
  const Recording recording = aircraft::testing::circling(circles);
  Reconstruction reconstruction;
  Channel density = recording.at("air_density");
  Channel error = make_channel(taken_off.first, "1", density.time, std::vector(density.size(), taken_off.second));
  reconstruction.smoothed.add(std::move(density));
  reconstruction.smoothed.add(std::move(error));
  Segments segments;
  segments.airborne = {{0.0, aircraft::testing::kCirclingEnd_s}};
  return air_data_evidence(recording, reconstruction, true, segments);
}

Evidence row_in(const CheckedFlight& checked, Check check, std::string_view about) {
  for (const Evidence& row : checked.rows)
    if (row.check == check && row.about == about) return row;
  throw std::logic_error("no row " + std::string(to_string(check)));
}

// In calm air the headings determine the scale to a fraction of a per cent.
TEST(AirDataEvidence, GradesTheScaleOfTheAirspeed) {
  const auto row = [](double scale) {
    return row_in(circled({.scale = scale, .gust = 0.05}), Check::kAirspeedScale, "airspeed");
  };
  EXPECT_EQ(row(1.0).outcome, Outcome::kPassed) << says(row(1.0));
  EXPECT_EQ(row(1.05).outcome, Outcome::kCare) << says(row(1.05));
  EXPECT_EQ(row(0.8).outcome, Outcome::kFailed) << says(row(0.8));
  EXPECT_EQ(row(0.8).cause, Cause::kScale);
  EXPECT_EQ(row(1.9438).cause, Cause::kUnit);
  EXPECT_THAT(says(row(1.9438)), ::testing::HasSubstr("kt taken for m/s"));
  EXPECT_FALSE(advice_of(row(0.8)).empty());
  // What the reconstruction found of the pitot tube, in pressure, is not held against it.
  const CheckedFlight taken_off = circled({.scale = std::sqrt(1.2), .gust = 0.05}, {"pitot_scale", 0.2});
  EXPECT_EQ(row_in(taken_off, Check::kAirspeedScale, "airspeed").outcome, Outcome::kPassed);
}

// A scale that is known to be beyond the limit is, though its upper end of three standard errors is not.
TEST(AirDataEvidence, JudgesAScaleThatIsKnownByItsEstimate) {
  for (const double gust : {0.2, 0.4}) {
    const Evidence row = row_in(circled({.scale = 0.973, .gust = gust}), Check::kAirspeedScale, "airspeed");
    if (!(row.sigma < 0.008)) continue;
    EXPECT_EQ(row.outcome, Outcome::kCare) << says(row);
    EXPECT_EQ(row.cause, Cause::kScale);
  }
  const Evidence within = row_in(circled({.scale = 0.99, .gust = 0.05}), Check::kAirspeedScale, "airspeed");
  EXPECT_EQ(within.outcome, Outcome::kPassed) << says(within);
}

TEST(AirDataEvidence, SaysHowWellGustsLetTheScaleBeVerified) {
  const CheckedFlight gusty = circled({.gust = 1.5});
  const Evidence row = row_in(gusty, Check::kAirspeedScale, "airspeed");
  EXPECT_EQ(row.outcome, Outcome::kNotVerified) << says(row);
  EXPECT_EQ(row.cause, Cause::kNoise);
  EXPECT_GT(doubt_about(gusty.doubts, FlightSignal::kAirspeed), 0.01);
}

TEST(AirDataEvidence, GradesTheZeroOfAVane) {
  const auto row = [](double bias, double taken_off = 0.0) {
    return row_in(circled({.alpha_bias = bias, .gust = 0.05}, {"alpha_bias", taken_off}), Check::kVaneAngle, "alpha");
  };
  EXPECT_EQ(row(0.0).outcome, Outcome::kNotVerified) << says(row(0.0));
  EXPECT_EQ(row(3.0 * kDegree).outcome, Outcome::kCare) << says(row(3.0 * kDegree));
  EXPECT_NEAR(row(3.0 * kDegree).value, 3.0, 0.2);
  EXPECT_EQ(row(8.0 * kDegree).outcome, Outcome::kFailed);
  EXPECT_EQ(row(3.0 * kDegree, 3.0 * kDegree).outcome, Outcome::kNotVerified) << "found and taken off";
  EXPECT_EQ(row(2.0).cause, Cause::kUnit);
  EXPECT_FALSE(affects(row(0.0), Coefficient::kCn));
}

// Without gyro and accelerometer nothing is compared, which is no alarm.
TEST(AirDataEvidence, SaysThatTheScaleOfAVaneIsNotVerified) {
  const CheckedFlight checked = circled({});
  for (const auto& [name, signal] : {std::pair{"alpha", FlightSignal::kAlpha}, {"beta", FlightSignal::kBeta}}) {
    EXPECT_EQ(row_in(checked, Check::kVaneScale, name).outcome, Outcome::kNotVerified);
    EXPECT_NEAR(doubt_about(checked.doubts, signal), 0.2, 1e-12) << "what is left is the prior";
  }
}

}  // namespace
}  // namespace veridyn::aircraft
