#include "veridyn/aircraft/identification/evidence/contradicted_flight.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/campaign/campaign.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::campaign_flight;
using aircraft::testing::fault;
using aircraft::testing::Identified;
using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;
using estimation::row_of;
using ::testing::HasSubstr;

double largest_speed(const Recording& recording) {
  double most = 0.0;
  for (const char* name : {"airspeed", "vel_north", "vel_east", "vel_down"})
    if (const Channel* channel = recording.find(name))
      for (const double v : channel->value) most = std::max(most, std::abs(v));
  return most;
}

// Each of these ran away to between 100 and 2900 m/s before.
TEST(ContradictedFlight, IsGradedNoWithTheSensorThatIsWrongAndIdentifiesNothing) {
  const FlightStudy study = campaign_flight("unatrap", 1, 100.0);
  for (const auto& [name, about] : {std::pair{"accelerometer without gravity", "accelerometer"},
                                    {"accelerometer in g", "accelerometer"},
                                    {"accelerometer z reversed", "accelerometer"},
                                    {"gyro in deg/s", "gyro"},
                                    {"attitude in degrees", "roll"},
                                    {"velocity in km/h", "ground velocity"},
                                    {"north and east swapped", "ground velocity"}}) {
    FlightStudy faulty = study;
    fault(name).apply(faulty);
    const Identified flight = aircraft::testing::identified(faulty);
    ASSERT_FALSE(flight.refused) << name << flight.message;
    const FlightAnalysis& analysis = flight.analysis;
    ASSERT_TRUE(analysis.flights.front().reconstruction.contradiction.has_value()) << name;
    const estimation::Estimate& estimate = analysis.estimate;
    EXPECT_EQ(estimate.judgement.data.grade, estimation::Grade::kNo) << name;
    EXPECT_EQ(estimate.judgement.parameters.grade, estimation::Grade::kNo) << name;
    EXPECT_TRUE(estimate.parameters.empty()) << name;
    EXPECT_THAT(estimate.verdict, HasSubstr("skipped: CL, CD, CY, Cl, Cm, Cn"));
    const Evidence& row = estimate.evidence.front();
    EXPECT_EQ(row.check, Check::kDeadReckoning);
    EXPECT_EQ(row.about, about) << name << ": " << says(row);
    EXPECT_LT(largest_speed(analysis.flights.front().reconstruction.smoothed),
              1.2 * largest_speed(faulty.mapped.recording) + 10.0)
        << name;
  }
}

TEST(ContradictedFlight, IsNoneOfTheBuiltInAircrafts) {
  for (const std::string& name : builtin_subject_names()) {
    FlightStudy study = campaign_flight(name, 2, 60.0);
    Progress silent;
    const Reconstruction r = reconstruct(study, silent).flights.front().reconstruction;
    EXPECT_FALSE(r.contradiction.has_value()) << name << ": " << r.contradiction->statement;
    for (const SensorReport& sensor : r.sensors) EXPECT_LT(sensor.innovations.unsupported_s, 0.5) << name;
  }
}

TEST(ContradictedFlight, FliesWhereItsOwnAirspeedSays) {
  Recording recording;
  std::vector<double> stamps, speed, zero;
  for (int k = 0; k <= 1000; ++k) {
    const double t = 0.1 * k;
    stamps.push_back(t);
    speed.push_back(t > 20.0 && t < 80.0 ? 15.0 : 1.0);
    zero.push_back(0.0);
  }
  const TimeBase time = make_time_base(stamps);
  recording.add(make_channel("gyro_x", "rad/s", time, zero));
  recording.add(make_channel("vel_north", "m/s", time, zero));
  recording.add(make_channel("vel_east", "m/s", time, speed));
  for (const char* source : {"ground speed", "dynamic_pressure", "airspeed"}) {
    const Segments segments = recorded_flight(recording, 10.0);
    ASSERT_EQ(segments.airborne.size(), 1u) << source;
    EXPECT_NEAR(segments.airborne[0].begin, 20.0, 0.2) << source;
    EXPECT_NEAR(segments.airborne[0].end, 80.0, 0.2) << source;
    std::vector<double> pressure = speed;
    for (double& v : pressure) v = 0.5 * 1.225 * v * v;
    if (!recording.has("dynamic_pressure")) {
      recording.add(make_channel("dynamic_pressure", "Pa", time, pressure));
    } else if (!recording.has("airspeed")) {
      recording.add(make_channel("airspeed", "m/s", time, speed));
    }
  }
}

TEST(ContradictedFlight, RowIsAboutTheSensorThatWasRefusedWhereNoOtherIsFoundWrong) {
  Contradiction contradiction;
  contradiction.channel = "vel_down";
  contradiction.against = "accelerometer and attitude";
  contradiction.span = {30.0, 45.0};
  const Evidence alone = contradiction_row(contradiction, 10.0, {});
  EXPECT_EQ(alone.about, "vel_down");
  EXPECT_EQ(alone.outcome, Outcome::kFailed);
  EXPECT_EQ(alone.cause, Cause::kNone);
  EXPECT_THAT(advice_of(alone), HasSubstr("data.to = 30"));
  const std::vector<Evidence> causes{row_of(Check::kVaneScale, "alpha", Outcome::kFailed),
                                     row_of(Check::kSensorGain, "gyro", Outcome::kPassed),
                                     row_of(Check::kAccelerometerBias, "accelerometer", Outcome::kFailed)};
  EXPECT_EQ(contradiction_row(contradiction, 10.0, causes).about, "accelerometer");
  // One that is wrong with care is the cause where no other is worse.
  const std::vector<Evidence> with_care{row_of(Check::kSensorGain, "ground velocity", Outcome::kCare), causes.back()};
  EXPECT_EQ(contradiction_row(contradiction, 10.0, with_care).about, "accelerometer");
  EXPECT_EQ(contradiction_row(contradiction, 10.0, {with_care.data(), 1}).about, "ground velocity");
  // An attitude that leaves the gyro has no cause in the accelerometer.
  contradiction.by_gyro = true;
  EXPECT_EQ(contradiction_row(contradiction, 10.0, causes).about, "vel_down");
}

}  // namespace
}  // namespace veridyn::aircraft
