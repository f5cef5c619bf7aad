#include "veridyn/aircraft/identification/evidence/recording_evidence.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/aircraft/campaign/campaign.hpp"
#include "tests/aircraft/simulated_flight.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/judgement.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::Flown;
using aircraft::testing::fly;
using aircraft::testing::reconstructed;
using aircraft::testing::reference_options;
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

std::vector<FlightEvidence> evidence_of(const Recording& recording) {
  Flown flight = flown();
  flight.measured = recording;
  const ReconstructOptions options = reference_options();
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  return recording_evidence(recording, reconstructed(flight, options), options, segments);
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

Grade data_grade(const std::vector<FlightEvidence>& rows) {
  std::vector<estimation::Evidence> plain;
  for (const FlightEvidence& row : rows) plain.push_back(row.row);
  return estimation::judge(plain).data.grade;
}

std::string texts(const std::vector<FlightEvidence>& rows) {
  std::string all;
  for (const FlightEvidence& row : rows) all += std::string(to_string(row.row.outcome)) + ": " + row.row.text + "\n";
  return all;
}

const FlightEvidence* find(const std::vector<FlightEvidence>& rows, std::string_view about, Outcome outcome) {
  const auto found = std::ranges::find_if(
      rows, [&](const FlightEvidence& e) { return e.row.about == about && e.row.outcome == outcome; });
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
    return *std::ranges::find(estimate.evidence, fmt::format("scale of the {} vane", vane),
                              &estimation::Evidence::name);
  };
  for (const char* vane : {"alpha", "beta"}) {
    const estimation::Evidence clean = scale_of(study, vane);
    EXPECT_NEAR(clean.value, 1.0, 0.15);
    EXPECT_TRUE(clean.passed()) << clean.text;
    FlightStudy doubled = study;
    Channel channel = doubled.mapped.recording.at(vane);
    for (double& v : channel.value) v *= 2.0;
    doubled.mapped.recording.set(std::move(channel));
    const estimation::Evidence row = scale_of(doubled, vane);
    EXPECT_NEAR(row.value, 2.0 * clean.value, 0.1);
    EXPECT_FALSE(row.passed()) << row.text;
  }
}

TEST(RecordingEvidence, NamesWhatTheClocksShow) {
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  const auto rows_with = [&](const DelayReport& report) {
    return recording_evidence(flown().measured, clean_reconstruction(), reference_options(), segments,
                              std::vector<DelayReport>{report});
  };
  const auto gyro = rows_with({"attitude", "gyro", -0.1, 0.005, 0.9, recording::DelayFinding::kApplied});
  EXPECT_NE(find(gyro, "gyro", Outcome::kCare), nullptr) << texts(gyro);
  const auto elevator = rows_with({"elevator", "angular acceleration", -0.15, 0.0, 0.9, recording::DelayFinding::kBeforeCause});
  EXPECT_NE(find(elevator, "elevator", Outcome::kCare), nullptr) << texts(elevator);
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
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  const auto row = [&](const char* vane, double delay_s, double sigma_s, bool applied, const char* text = "") {
    const auto rows =
        recording_evidence(flown().measured, clean_reconstruction(), reference_options(), segments,
                           std::vector<DelayReport>{{vane, "lift", delay_s, sigma_s, 0.99, applied, text}});
    const auto of_vane = std::ranges::find(rows, "delay of a vane", [](const FlightEvidence& r) { return r.row.name; });
    return of_vane == rows.end() ? std::string() : of_vane->row.text;
  };
  EXPECT_THAT(row("alpha", 0.149, 0.145, false),
              ::testing::HasSubstr("how late the alpha vane is cannot be seen (0.149 +- 0.145"));
  EXPECT_THAT(row("beta", 0.0, 0.02, false), HasSubstr("beta vane"));
  EXPECT_EQ(row("alpha", 0.005, 0.005, false), "");
  EXPECT_EQ(row("alpha", 0.2, 0.005, true, "applied"), "") << "taken off";
  EXPECT_THAT(row("alpha", 0.2, 0.03, true, "applied"),
              HasSubstr("not well known (0.200 +- 0.030 s): it is taken as found"));
  EXPECT_THAT(row("alpha", 0.0, 0.0, false, "not determined: the force explains too little"),
              ::testing::HasSubstr("cannot be seen: it is taken as recorded"));
  EXPECT_EQ(row("gps", 0.1, 0.1, false), "");
}

TEST(RecordingEvidence, NamesAVaneWhoseDelaysContradictEachOther) {
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  DelayReport vane{"beta", "gyro, accelerometer and attitude", 0.06, 0.003, 0.99, recording::DelayFinding::kApplied};
  vane.contradicted_by = {"side force (accel_y)", 0.02, 0.005};
  const auto rows = recording_evidence(flown().measured, clean_reconstruction(), reference_options(), segments,
                                       std::vector<DelayReport>{vane});
  const auto row = std::ranges::find(rows, "delay of a vane", [](const FlightEvidence& r) { return r.row.name; });
  ASSERT_NE(row, rows.end()) << texts(rows);
  EXPECT_EQ(row->row.outcome, Outcome::kCare);
  EXPECT_THAT(row->row.text,
              HasSubstr("0.060 +- 0.003 s late by gyro, accelerometer and attitude, but 0.020 +- 0.005 s "
                        "by side force"));
}

TEST(RecordingEvidence, SaysWhichSurfacesHaveNoDelayOfTheirOwn) {
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  DelayReport aileron{"aileron", "angular acceleration", 0.1, 0.02, 0.9, recording::DelayFinding::kApplied};
  const auto rows_with = [&](const std::vector<DelayReport>& delays) {
    return recording_evidence(flown().measured, clean_reconstruction(), reference_options(), segments, delays);
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
  const FlightEvidence* row = find(degrees, "alpha", Outcome::kFailed);
  ASSERT_NE(row, nullptr) << texts(degrees);
  EXPECT_TRUE(row->bears_on(Coefficient::kCL));
  EXPECT_FALSE(row->bears_on(Coefficient::kCn)) << "the lateral coefficients do not rest on alpha";
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

const FlightEvidence* named(const std::vector<FlightEvidence>& rows, std::string_view name, std::string_view about) {
  const auto found =
      std::ranges::find_if(rows, [&](const FlightEvidence& e) { return e.row.name == name && e.row.about == about; });
  return found == rows.end() ? nullptr : &*found;
}

TEST(RecordingEvidence, NamesTheSensorWhoseSamplesTheReconstructionRefuses) {
  const auto clean = evidence_of(flown().measured);
  const FlightEvidence* right = named(clean, "agreement with the reconstruction", "beta");
  ASSERT_NE(right, nullptr);
  EXPECT_EQ(right->row.outcome, Outcome::kPassed) << right->row.text;
  Recording recording = flown().measured;
  Channel beta = recording.at("beta");
  for (std::size_t i = 0; i < beta.size(); i += 20) beta.value[i] += 0.6;
  recording.set(std::move(beta));
  const auto rows = evidence_of(recording);
  const FlightEvidence* wrong = named(rows, "agreement with the reconstruction", "beta");
  ASSERT_NE(wrong, nullptr);
  EXPECT_FALSE(wrong->row.passed()) << wrong->row.text;
  EXPECT_FALSE(wrong->bears_on(Coefficient::kCL));
}

// The row that names the sensor counts as much as the refusal that follows from it, and no more without one.
TEST(RecordingEvidence, ACauseCountsAsMuchAsWhatFollowsFromIt) {
  Segments segments;
  segments.airborne = {{5.0, 115.0}};
  const std::vector<DelayReport> gyro_late{{"attitude", "gyro", -0.1, 0.005, 0.9, recording::DelayFinding::kApplied}};
  const auto with_refused = [&](double share) {
    Reconstruction reconstruction = clean_reconstruction();
    for (SensorReport& sensor : reconstruction.sensors)
      if (sensor.channel == "yaw")
        sensor.innovations.rejected = static_cast<std::size_t>(share * static_cast<double>(sensor.innovations.count));
    return recording_evidence(flown().measured, reconstruction, reference_options(), segments, gyro_late);
  };
  const auto outcome_in = [&](double share, std::string_view name, std::string_view about) {
    return named(with_refused(share), name, about)->row.outcome;
  };
  EXPECT_EQ(outcome_in(0.1, "agreement with the reconstruction", "yaw"), Outcome::kCare);
  EXPECT_EQ(outcome_in(0.1, "delay of the gyro", "gyro"), Outcome::kCare);
  EXPECT_EQ(outcome_in(0.3, "agreement with the reconstruction", "yaw"), Outcome::kFailed);
  EXPECT_EQ(outcome_in(0.3, "delay of the gyro", "gyro"), Outcome::kFailed);
}

TEST(RecordingEvidence, MeanGustsAreThoseThatTurbulenceLeaves) {
  const auto clean = evidence_of(flown().measured);
  const auto gust = std::ranges::find_if(clean, [](const FlightEvidence& e) { return e.row.name == "mean gust"; });
  ASSERT_NE(gust, clean.end());
  EXPECT_EQ(gust->row.outcome, Outcome::kPassed) << gust->row.text;
}

TEST(RecordingEvidence, SaysThatAFlightIsShorterThanItsSlowestOscillation) {
  const auto row_for = [&](double end) {
    Segments segments;
    segments.airborne = {{5.0, end}};
    const auto rows = recording_evidence(flown().measured, clean_reconstruction(), reference_options(), segments);
    const FlightEvidence* row = named(rows, "length of the flight", "");
    return row == nullptr ? estimation::Evidence{.outcome = Outcome::kMissing} : row->row;
  };
  // At 20 m/s: pi sqrt(2) 20 / 9.81 = 9.06 s.
  EXPECT_NEAR(row_for(115.0).limit, 9.06, 0.5);
  EXPECT_EQ(row_for(115.0).outcome, Outcome::kPassed);
  EXPECT_EQ(row_for(12.0).outcome, Outcome::kCare);
}

TEST(FlightEvidence, BearsOnAllCoefficientsUnlessItSaysWhich) {
  const FlightEvidence all, some{.row = {}, .affects = {Coefficient::kCY}};
  EXPECT_TRUE(all.bears_on(Coefficient::kCm));
  EXPECT_TRUE(some.bears_on(Coefficient::kCY));
  EXPECT_FALSE(some.bears_on(Coefficient::kCL));
}

}  // namespace
}  // namespace veridyn::aircraft
