#include "veridyn/aircraft/identification/evidence/air_data_evidence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/aircraft/circling_flight.hpp"
#include "tests/aircraft/stripped_recording.hpp"
#include "veridyn/aircraft/reconstruction/corrected_flow.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;

/// A flight of 150 s with a channel scaled.
PreparedFlight evidence_with(const char* channel, double factor, const char* turbulence) {
  FlightStudy study = aircraft::testing::campaign_flight("unatrap", 1, 150.0, turbulence);
  Channel changed = study.mapped.recording.at(channel);
  for (double& v : changed.value) v *= factor;
  study.mapped.recording.set(std::move(changed));
  return aircraft::testing::identified(study).analysis.flights.front();
}

double scale_of(const std::vector<SensorError>& errors, BudgetSensor sensor, double SensorError::*figure) {
  for (const SensorError& error : errors)
    if (error.sensor == sensor && error.kind == SensorErrorKind::kScale) return error.*figure;
  return kNaN;
}

double doubt_about(const std::vector<SensorError>& errors, BudgetSensor sensor) {
  return scale_of(errors, sensor, &SensorError::sigma);
}

TEST(AirDataEvidence, LeavesLittleInDoubtInCalmAirAndMoreInTurbulence) {
  const std::vector<SensorError> calm = evidence_with("alpha", 1.0, "none").budget.errors;
  const std::vector<SensorError> rough = evidence_with("alpha", 1.0, "low_moderate").budget.errors;
  for (const BudgetSensor sensor : {BudgetSensor::kAirspeed, BudgetSensor::kAlpha, BudgetSensor::kBeta}) {
    EXPECT_LT(doubt_about(calm, sensor), 0.05) << kBudgetSensorNames[sensor];
    EXPECT_GT(doubt_about(rough, sensor), doubt_about(calm, sensor));
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
  EXPECT_GT(doubt_about(rough.budget.errors, BudgetSensor::kAirspeed), 0.02);
  // The mean is taken off: 1.2 of pressure are 1.095 of airspeed.
  EXPECT_NEAR(scale_of(calm.budget.errors, BudgetSensor::kAirspeed, &SensorError::mean), 0.095, 0.02);
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
  const FlowSensors vanes = flow_sensors({}, reconstruction.smoothed);
  return air_data_evidence(
      with_corrected_flow({.recording = recording}, vanes, reconstruction.smoothed).mapped.recording, reconstruction,
      true, segments);
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
  EXPECT_GT(doubt_about(gusty.errors, BudgetSensor::kAirspeed), 0.01);
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

// Without ground velocity there is nothing to compare with, which leaves the priors and not certainty.
TEST(AirDataEvidence, LeavesThePriorsWhereNothingIsMeasured) {
  Recording recording = aircraft::testing::circling({});
  Reconstruction reconstruction;
  reconstruction.smoothed.add(recording.at("air_density"));
  recording = aircraft::testing::without(recording, {"vel_north", "vel_east", "vel_down"});
  const CheckedFlight checked = air_data_evidence(recording, reconstruction, true, {});
  EXPECT_TRUE(checked.rows.empty());
  EXPECT_GE(doubt_about(checked.errors, BudgetSensor::kAirspeed), 0.05);
  EXPECT_EQ(doubt_about(checked.errors, BudgetSensor::kAlpha), 0.1);
  EXPECT_EQ(doubt_about(checked.errors, BudgetSensor::kAirDensity), 0.01);
  const KnownSensors known{{{BudgetSensor::kAlpha, SensorErrorKind::kScale, 0.05, 0.01}}};
  const CheckedFlight calibrated = air_data_evidence(recording, reconstruction, true, {}, known);
  EXPECT_EQ(doubt_about(calibrated.errors, BudgetSensor::kAlpha), 0.01);
  EXPECT_EQ(scale_of(calibrated.errors, BudgetSensor::kAlpha, &SensorError::mean), 0.05);
}

// Without gyro and accelerometer nothing is compared, which is no alarm.
TEST(AirDataEvidence, SaysThatTheScaleOfAVaneIsNotVerified) {
  const CheckedFlight checked = circled({});
  for (const auto& [name, sensor] : {std::pair{"alpha", BudgetSensor::kAlpha}, {"beta", BudgetSensor::kBeta}}) {
    EXPECT_EQ(row_in(checked, Check::kVaneScale, name).outcome, Outcome::kNotVerified);
    EXPECT_NEAR(doubt_about(checked.errors, sensor), 0.1, 1e-12) << "what is left is the prior";
  }
}

}  // namespace
}  // namespace veridyn::aircraft
