#include "veridyn/aircraft/identification/evidence/recording_evidence.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/aircraft/simulated_flight.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/judgement.hpp"
#include "veridyn/recording/inertial_consistency.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::Flown;
using aircraft::testing::fly;
using aircraft::testing::reconstructed;
using aircraft::testing::reference_options;
using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Grade;
using estimation::Outcome;
using ::testing::HasSubstr;

const Flown& flown() {
  static const Flown flight = fly({.duration = 120.0, .seed = 4});
  return flight;
}

const Reconstruction& clean_reconstruction() {
  static const Reconstruction reconstruction = reconstructed(flown(), reference_options());
  return reconstruction;
}

std::vector<Evidence> evidence_of(const Recording& recording) {
  Flown flight = flown();
  flight.measured = recording;
  const ReconstructOptions options = reference_options();
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  return recording_evidence(recording, reconstructed(flight, options), options, segments).rows;
}

Recording changed(std::initializer_list<const char*> channels, double factor, double offset = 0.0) {
  Recording recording = flown().measured;
  for (const char* name : channels) {
    Channel channel = recording.at(name);
    for (double& v : channel.value) v = factor * v + offset;
    recording.set(std::move(channel));
  }
  return recording;
}

Grade data_grade(const std::vector<Evidence>& rows) { return estimation::judge(rows).data.grade; }

std::string texts(const std::vector<Evidence>& rows) {
  std::string all;
  for (const Evidence& row : rows) all += std::string(to_string(row.outcome)) + ": " + says(row) + "\n";
  return all;
}

const Evidence* find(const std::vector<Evidence>& rows, std::string_view about, Outcome outcome) {
  const auto found =
      std::ranges::find_if(rows, [&](const Evidence& row) { return row.about == about && row.outcome == outcome; });
  return found == rows.end() ? nullptr : &*found;
}

const Evidence* find(const std::vector<Evidence>& rows, Check check, std::string_view about = "") {
  const auto found = std::ranges::find_if(
      rows, [&](const Evidence& row) { return row.check == check && (about.empty() || row.about == about); });
  return found == rows.end() ? nullptr : &*found;
}

TEST(RecordingEvidence, OfACleanFlightInModerateTurbulenceIsYes) {
  const auto rows = evidence_of(flown().measured);
  EXPECT_EQ(data_grade(rows), Grade::kYes) << texts(rows);
  // What no flight can tell is said.
  EXPECT_NE(find(rows, "controls", Outcome::kNotVerified), nullptr);
  EXPECT_NE(find(rows, "body", Outcome::kNotVerified), nullptr);
}

// The scale of a vane against gyro and accelerometer in manoeuvres, with the control as instrument: by least squares
// the slope would be 0.2, since the aircraft answers gusts.
TEST(RecordingEvidence, FindsTheScaleOfTheVanes) {
  const FlightStudy study = aircraft::testing::campaign_flight("unatrap", 1, 300.0);
  const auto scale_of = [](const FlightStudy& flight, const char* vane) {
    const estimation::Estimate estimate = aircraft::testing::identified(flight).analysis.estimate;
    return *find(estimate.evidence, Check::kVaneScale, vane);
  };
  for (const char* vane : {"alpha", "beta"}) {
    const Evidence clean = scale_of(study, vane);
    EXPECT_NEAR(clean.value, 1.0, 0.15);
    EXPECT_TRUE(clean.passed()) << says(clean);
    FlightStudy doubled = study;
    Channel channel = doubled.mapped.recording.at(vane);
    for (double& v : channel.value) v *= 2.0;
    doubled.mapped.recording.set(std::move(channel));
    const Evidence row = scale_of(doubled, vane);
    EXPECT_NEAR(row.value, 2.0 * clean.value, 0.1);
    EXPECT_FALSE(row.passed()) << says(row);
  }
}

TEST(RecordingEvidence, NamesWhatTheClocksShow) {
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  const auto rows_with = [&](const DelayReport& report) {
    return recording_evidence(flown().measured, clean_reconstruction(), reference_options(), segments,
                              std::vector<DelayReport>{report})
        .rows;
  };
  const auto gyro = rows_with({"attitude", "gyro", -0.1, 0.005, 0.9, recording::DelayFinding::kApplied});
  EXPECT_NE(find(gyro, "gyro", Outcome::kCare), nullptr) << texts(gyro);
  const auto elevator =
      rows_with({"elevator", "angular acceleration", -0.15, 0.0, 0.9, recording::DelayFinding::kBeforeCause});
  EXPECT_NE(find(elevator, "elevator", Outcome::kFailed), nullptr) << texts(elevator);
  const auto servo_lag =
      rows_with({"elevator", "angular acceleration", -0.06, 0.0, 0.9, recording::DelayFinding::kBeforeCause});
  EXPECT_NE(find(servo_lag, "elevator", Outcome::kCare), nullptr) << texts(servo_lag);
  const auto late = rows_with({"gps", "specific force", 0.2, 0.01, 0.9, recording::DelayFinding::kApplied});
  EXPECT_EQ(find(late, "gps", Outcome::kCare), nullptr) << texts(late);
  EXPECT_EQ(data_grade(late), Grade::kYes) << texts(late);
  const auto opposite = rows_with({"gps", "specific force", 0.0, 0.01, -0.9, recording::DelayFinding::kOppositeSign});
  EXPECT_NE(find(opposite, "gps", Outcome::kCare), nullptr) << texts(opposite);
  // A deflection that leads by what more is unexplained of than explained; a sensor that is late is taken as it is.
  DelayReport servo{"elevator", "angular acceleration", 0.07, 0.01, 0.6, recording::DelayFinding::kInDoubt};
  EXPECT_NE(find(rows_with(servo), "elevator", Outcome::kCare), nullptr) << texts(rows_with(servo));
  servo.group = "alpha";
  EXPECT_EQ(find(rows_with(servo), "alpha", Outcome::kCare), nullptr) << texts(rows_with(servo));
}

TEST(RecordingEvidence, SaysWhereAVanesDelayCannotBeSeen) {
  using Finding = recording::DelayFinding;
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  const auto cause = [&](const char* vane, double delay_s, double sigma_s, Finding finding) -> std::optional<Cause> {
    const auto rows = recording_evidence(flown().measured, clean_reconstruction(), reference_options(), segments,
                                         std::vector<DelayReport>{{vane, "lift", delay_s, sigma_s, 0.99, finding}})
                          .rows;
    const Evidence* row = find(rows, Check::kVaneDelay);
    if (row == nullptr) return std::nullopt;
    EXPECT_EQ(row->outcome, Outcome::kNotVerified);
    EXPECT_EQ(row->about, vane);
    return row->cause;
  };
  EXPECT_EQ(cause("alpha", 0.149, 0.145, Finding::kWide), Cause::kNoise);
  EXPECT_EQ(cause("beta", 0.0, 0.02, Finding::kSmall), Cause::kNoise);
  EXPECT_EQ(cause("alpha", 0.005, 0.005, Finding::kSmall), std::nullopt);
  EXPECT_EQ(cause("alpha", 0.2, 0.005, Finding::kApplied), std::nullopt) << "taken off";
  EXPECT_EQ(cause("alpha", 0.2, 0.03, Finding::kApplied), Cause::kDelay);
  EXPECT_EQ(cause("alpha", 0.0, 0.0, Finding::kLittleExplained), Cause::kExcitation);
  EXPECT_EQ(cause("gps", 0.1, 0.1, Finding::kWide), std::nullopt);
}

TEST(RecordingEvidence, NamesAVaneWhoseDelaysContradictEachOther) {
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  DelayReport vane{"beta", "gyro, accelerometer and attitude", 0.06, 0.003, 0.99, recording::DelayFinding::kApplied};
  vane.contradicted_by = {"side force (accel_y)", 0.02, 0.005};
  const auto rows = recording_evidence(flown().measured, clean_reconstruction(), reference_options(), segments,
                                       std::vector<DelayReport>{vane})
                        .rows;
  const Evidence* row = find(rows, Check::kVaneDelayContradicted);
  ASSERT_NE(row, nullptr) << texts(rows);
  EXPECT_EQ(row->outcome, Outcome::kCare);
  EXPECT_NEAR(row->value, -0.04, 1e-12);
  EXPECT_THAT(says(*row), HasSubstr("0.060 +- 0.003 s late by gyro, accelerometer and attitude, but 0.020 +- 0.005 s "
                                    "by side force"));
}

TEST(RecordingEvidence, SaysWhichSurfacesHaveNoDelayOfTheirOwn) {
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  DelayReport aileron{"aileron", "angular acceleration", 0.1, 0.02, 0.9, recording::DelayFinding::kApplied};
  const auto rows_with = [&](const std::vector<DelayReport>& delays) {
    return recording_evidence(flown().measured, clean_reconstruction(), reference_options(), segments, delays).rows;
  };
  const DelayReport alone = aileron;
  aileron.together = {"aileron", "rudder"};
  DelayReport rudder = aileron;
  rudder.group = "rudder";
  const auto together = rows_with({aileron, rudder});
  EXPECT_NE(find(together, "aileron and rudder", Outcome::kNotVerified), nullptr) << texts(together);
  EXPECT_EQ(together.size(), rows_with({alone}).size() + 1);
}

TEST(RecordingEvidence, NamesDeflectionsInDegrees) {
  const auto rows = evidence_of(changed({"elevator"}, 1.0 / kDegree));
  EXPECT_NE(find(rows, "elevator", Outcome::kFailed), nullptr) << texts(rows);
}

TEST(RecordingEvidence, NamesTheAccelerometerThatIsInGOrFreeOfGravity) {
  const auto in_g = evidence_of(changed({"accel_x", "accel_y", "accel_z"}, 1.0 / kGravity));
  EXPECT_EQ(data_grade(in_g), Grade::kNo);
  EXPECT_NE(find(in_g, "accelerometer", Outcome::kFailed), nullptr) << texts(in_g);
  const auto without_gravity = evidence_of(changed({"accel_z"}, 1.0, kGravity));
  EXPECT_NE(find(without_gravity, "accelerometer", Outcome::kFailed), nullptr) << texts(without_gravity);
}

TEST(RecordingEvidence, NamesTheVaneThatIsInDegreesOrOffZero) {
  const auto degrees = evidence_of(changed({"alpha"}, 1.0 / kDegree));
  const Evidence* row = find(degrees, "alpha", Outcome::kFailed);
  ASSERT_NE(row, nullptr) << texts(degrees);
  EXPECT_TRUE(affects(*row, Coefficient::kCL));
  EXPECT_FALSE(affects(*row, Coefficient::kCn)) << "the lateral coefficients do not rest on alpha";
  const auto off = evidence_of(changed({"alpha"}, 1.0, 8.0 * kDegree));
  EXPECT_NE(find(off, "alpha", Outcome::kCare), nullptr) << texts(off);
}

// This flight's headings do not separate the scale from the wind; the gusts that it would take are not turbulence.
TEST(RecordingEvidence, TakesAPitotTubeThatReadsTwiceWithCare) {
  const auto rows = evidence_of(changed({"dynamic_pressure"}, 4.0));
  EXPECT_EQ(data_grade(rows), Grade::kWithCare);
  EXPECT_NE(find(rows, "airspeed", Outcome::kNotVerified), nullptr) << texts(rows);
  EXPECT_NE(find(rows, "gust_x", Outcome::kCare), nullptr) << texts(rows);
}

TEST(RecordingEvidence, NamesTheSensorWhoseSamplesTheReconstructionRefuses) {
  const auto clean = evidence_of(flown().measured);
  const Evidence* right = find(clean, Check::kReconstructionAgreement, "beta");
  ASSERT_NE(right, nullptr);
  EXPECT_EQ(right->outcome, Outcome::kPassed) << says(*right);
  Recording recording = flown().measured;
  Channel beta = recording.at("beta");
  for (std::size_t i = 0; i < beta.size(); i += 20) beta.value[i] += 0.6;
  recording.set(std::move(beta));
  const auto rows = evidence_of(recording);
  const Evidence* wrong = find(rows, Check::kReconstructionAgreement, "beta");
  ASSERT_NE(wrong, nullptr);
  EXPECT_FALSE(wrong->passed()) << says(*wrong);
  EXPECT_FALSE(affects(*wrong, Coefficient::kCL));
}

// What the reconstruction refuses has a row of its own. Others keep what they found: that a flight is short, or a clock
// a little late, is no worse by it.
TEST(RecordingEvidence, ARefusedSensorMakesNoOtherRowWorse) {
  Segments segments;
  segments.airborne = {{5.0, 13.0}};
  const std::vector<DelayReport> gyro_late{{"attitude", "gyro", -0.1, 0.005, 0.9, recording::DelayFinding::kApplied}};
  Reconstruction reconstruction = clean_reconstruction();
  for (SensorReport& sensor : reconstruction.sensors)
    if (sensor.channel == "pitch")
      sensor.innovations.rejected = static_cast<std::size_t>(0.3 * static_cast<double>(sensor.innovations.count));
  const auto rows = recording_evidence(flown().measured, reconstruction, reference_options(), segments, gyro_late).rows;
  EXPECT_EQ(find(rows, Check::kReconstructionAgreement, "pitch")->outcome, Outcome::kFailed);
  EXPECT_EQ(find(rows, Check::kGyroDelay)->outcome, Outcome::kCare);
  EXPECT_EQ(find(rows, Check::kFlightLength)->outcome, Outcome::kCare);
}

// With both vanes and an airspeed no coefficient needs a heading, and a surface is of one axis.
TEST(RecordingEvidence, AChannelAffectsOnlyWhatRestsOnIt) {
  Reconstruction reconstruction = clean_reconstruction();
  for (SensorReport& sensor : reconstruction.sensors)
    if (sensor.channel == "yaw") sensor.innovations.rejected = sensor.innovations.count / 2;
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  const std::vector<DelayReport> late{{"rudder", "yaw", -0.22, 0.01, 0.9, recording::DelayFinding::kBeforeCause}};
  const auto rows = recording_evidence(flown().measured, reconstruction, reference_options(), segments, late).rows;
  const Evidence* yaw = find(rows, Check::kReconstructionAgreement, "yaw");
  ASSERT_NE(yaw, nullptr);
  EXPECT_EQ(yaw->outcome, Outcome::kFailed);
  for (const Coefficient c : enumerators<Coefficient, kCoefficients>()) EXPECT_FALSE(affects(*yaw, c)) << name_of(c);
  const Evidence* rudder = find(rows, Check::kOrderInTime, "rudder");
  ASSERT_NE(rudder, nullptr);
  EXPECT_EQ(rudder->outcome, Outcome::kFailed) << "a delay that turns the sign of a derivative";
  EXPECT_FALSE(affects(*rudder, Coefficient::kCm));
  EXPECT_TRUE(affects(*rudder, Coefficient::kCY));
}

// A vertical speed behind a filter of 2.5 s shows a third of what the accelerometer does: "z reads 4.8 +- 1 times the
// truth", off by 38 m/s^2, and everything was rejected.
TEST(RecordingEvidence, AVerticalSpeedBehindAFilterIsNoFaultOfTheAccelerometer) {
  Progress silent;
  Recording recording =
      read_study(
          Study::parse("seed = 1\n[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 300\nwind = [4, -2, 0]\n"
                       "wind_drift = 0.3\nturbulence = \"low_moderate\"\n",
                       "flight.toml"),
          silent)
          .mapped.recording;
  Channel down = recording.at("vel_down");
  double state = down.value.front();
  for (std::size_t k = 1; k < down.size(); ++k)
    down.value[k] = state += (1.0 - std::exp((down.times()[k - 1] - down.times()[k]) / 2.5)) * (down.value[k] - state);
  recording.set(std::move(down));
  const std::vector<TimeSpan> airborne{{5.0, 295.0}};
  const auto rows = recording::inertial_evidence(recording::inertial_consistency(recording, airborne));
  for (const Evidence& row : rows)
    if (row.about == "accelerometer") EXPECT_TRUE(row.passed()) << texts(rows);
}

TEST(RecordingEvidence, AControlAtRestIsNoFault) {
  Recording recording = flown().measured;
  Channel rudder = recording.at("rudder");
  for (std::size_t k = 0; k < rudder.size(); ++k)
    if (rudder.times()[k] > 30.0 && rudder.times()[k] < 75.0) rudder.value[k] = 0.01;
  recording.set(std::move(rudder));
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  const auto rows = recording_evidence(recording, clean_reconstruction(), reference_options(), segments).rows;
  const Evidence* row = find(rows, Check::kFrozenSamples, "rudder");
  ASSERT_NE(row, nullptr) << texts(rows);
  EXPECT_EQ(row->outcome, Outcome::kNotVerified);
  EXPECT_EQ(row->cause, Cause::kExcitation);
  EXPECT_EQ(data_grade(rows), Grade::kYes) << texts(rows);
}

}  // namespace
}  // namespace veridyn::aircraft
