#include "veridyn/aircraft/sensors/airspeed_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/aircraft/sensors/mapped_log.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::channel;
using aircraft::testing::log_with;
using aircraft::testing::map;
using ::testing::HasSubstr;

constexpr double kSeaLevel = 1.225;

/// A tube that reads 1/k of the dynamic pressure, so that its autopilot has learned the ratio 2 k/rho_0.
struct ArduPilotTube {
  std::vector<double> truth, pressure, airspeed;
};

ArduPilotTube tube(double ratio) {
  ArduPilotTube out;
  for (int i = 0; i < 60; ++i) {
    const double equivalent = 18.0 + 4.0 * std::sin(0.2 * i);
    out.truth.push_back(0.5 * kSeaLevel * equivalent * equivalent);
    out.pressure.push_back(equivalent * equivalent / ratio);
    out.airspeed.push_back(equivalent);
  }
  return out;
}

Recording ardupilot_log(const ArduPilotTube& of) {
  return log_with({channel("IMU.AccX", "m/s^2", {0, 1}), channel("ARSP.Airspeed", "m/s", of.airspeed),
                   channel("ARSP.DiffPress", "Pa", of.pressure)});
}

void expect_truth(const MappedRecording& mapped, const ArduPilotTube& of) {
  const Channel& pressure = mapped.recording.at("dynamic_pressure");
  for (std::size_t i = 0; i < of.truth.size(); ++i) EXPECT_NEAR(pressure.value[i], of.truth[i], 1e-6 * of.truth[i]);
  EXPECT_FALSE(mapped.recording.has("airspeed"));
}

std::string note_of(const MappedRecording& mapped, const char* name) {
  return std::ranges::find(mapped.origins, name, &recording::ChannelOrigin::channel)->note;
}

// Taken as it is, a tube of ratio 2.2 gives 17.2 m/s for 20.
TEST(AirspeedMap, TakesArduPilotsPressureWithItsRatio) {
  const ArduPilotTube of = tube(2.2);
  Recording log = ardupilot_log(of);
  log.parameters["ARSPD_RATIO"] = 2.2;
  const MappedRecording mapped = map(log);
  expect_truth(mapped, of);
  EXPECT_EQ(note_of(mapped, "dynamic_pressure"), "times ARSPD_RATIO 2.2");
  ASSERT_EQ(mapped.left.size(), 1u);
  EXPECT_EQ(mapped.left.front().source, "ARSP.Airspeed");
}

TEST(AirspeedMap, FindsTheRatioThatTheLogDoesNotSay) {
  const ArduPilotTube of = tube(1.7);
  Recording log = ardupilot_log(of);
  expect_truth(map(log), of);
  log.parameters["ARSPD_RATIO"] = 2.2;
  const MappedRecording learned = map(log);
  expect_truth(learned, of);
  EXPECT_THAT(note_of(learned, "dynamic_pressure"), HasSubstr("which is not ARSPD_RATIO"));
}

// A pressure with its offset is in no fixed ratio to the airspeed, which is then taken itself.
TEST(AirspeedMap, LeavesAPressureThatIsNotTheAirspeeds) {
  const ArduPilotTube of = tube(2.0);
  ArduPilotTube with_offset = of;
  for (std::size_t i = 0; i < with_offset.pressure.size(); ++i)
    with_offset.pressure[i] = 300.0 + 100.0 * std::cos(0.5 * static_cast<double>(i));
  const MappedRecording mapped = map(ardupilot_log(with_offset));
  expect_truth(mapped, of);
  EXPECT_EQ(note_of(mapped, "dynamic_pressure"), "of the indicated airspeed");
}

TEST(AirspeedMap, TakesThePressureAsItIsOnlyWhereNothingElseIs) {
  const MappedRecording mapped =
      map(log_with({channel("IMU.AccX", "m/s^2", {0, 1}), channel("ARSP.DiffPress", "Pa", {100, 120})}));
  EXPECT_EQ(mapped.recording.at("dynamic_pressure").value[1], 120.0);
  EXPECT_EQ(note_of(mapped, "dynamic_pressure"), "as the sensor gives it, without ARSPD_RATIO");
}

// The study's word counts: what it maps is the only one.
TEST(AirspeedMap, LeavesAllToAStudyThatMapsOneItself) {
  const ArduPilotTube of = tube(2.0);
  const MappedRecording mapped = map(ardupilot_log(of), "airspeed = \"ARSP.Airspeed\"\n");
  EXPECT_FALSE(mapped.recording.has("dynamic_pressure"));
  EXPECT_EQ(mapped.recording.at("airspeed").value, of.airspeed);
}

// A raw pressure of 1 Hz beside the true airspeed that PX4 has checked.
TEST(AirspeedMap, TakesPx4sValidatedAirspeedBeforeItsSensor) {
  const MappedRecording mapped =
      map(log_with({channel("vehicle_attitude.q[0]", "1", {1, 1}),
                    channel("airspeed_validated.true_airspeed_m_s", "m/s", {17.1, 17.2}),
                    channel("differential_pressure.differential_pressure_pa", "Pa", {60, 61}),
                    channel("airspeed.indicated_airspeed_m_s", "m/s", {15, 16})}));
  EXPECT_EQ(mapped.recording.at("airspeed").value[0], 17.1);
  EXPECT_FALSE(mapped.recording.has("dynamic_pressure"));
  EXPECT_EQ(mapped.left.size(), 2u);
}

TEST(AirspeedMap, TakesAnIndicatedAirspeedForWhatItIs) {
  const MappedRecording mapped = map(log_with(
      {channel("vehicle_attitude.q[0]", "1", {1, 1}), channel("airspeed.indicated_airspeed_m_s", "m/s", {15, 16}),
       channel("differential_pressure.differential_pressure_pa", "Pa", {60, 61})}));
  EXPECT_FALSE(mapped.recording.has("airspeed"));
  EXPECT_NEAR(mapped.recording.at("dynamic_pressure").value[0], 0.5 * kSeaLevel * 225.0, 1e-9);
}

}  // namespace
}  // namespace veridyn::aircraft
