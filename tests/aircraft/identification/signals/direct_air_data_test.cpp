#include "veridyn/aircraft/identification/signals/direct_air_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/reconstruction/reconstruct_flight.hpp"
#include "tests/aircraft/stripped_recording.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::aircraft {
namespace {

ReconstructOptions data_sheet() {
  ReconstructOptions o;
  o.sensors = NoiseSource::kReference;
  return o;
}

// Without noise and gusts the airspeed changes over seconds: through the filter it is the airspeed of the flight.
TEST(DirectAirData, IsTheAirspeedOfThePitotTubeAndTheVanesAsTheyAre) {
  const aircraft::testing::MadeFlight flight = aircraft::testing::make_flight(
      {.duration = 20.0, .spectrum = {200.0, 200.0, 50.0, 0.0, 0.0, 0.0}, .noise = false});
  const Recording direct = direct_air_data(flight.recording, data_sheet(), {});
  const Channel& airspeed = direct.at("airspeed");
  for (std::size_t i = 200; i < 1800; ++i) ASSERT_NEAR(airspeed.value[i], flight.airspeed[i], 1e-3) << i;
  EXPECT_EQ(direct.at("alpha").value, flight.recording.at("alpha").value);
  EXPECT_EQ(direct.at("roll").value, flight.recording.at("roll").value);
  EXPECT_EQ(direct.at("air_density").value.front(), 1.2);
}

// sigma of sqrt(2 q / rho) is sigma_q / (rho Va), less what the filter takes off it.
TEST(DirectAirData, StatesTheErrorThatTheFilterLeavesOfTheTubes) {
  const aircraft::testing::MadeFlight flight = aircraft::testing::make_flight({.duration = 20.0, .noise = false});
  SignalOptions options;
  options.pass_Hz = 5.0;
  const Recording direct = direct_air_data(flight.recording, data_sheet(), options);
  numerics::LowPassDesign design{.rate_Hz = 100.0, .pass_Hz = 5.0, .stop_Hz = 7.5};
  const double left = std::sqrt(numerics::low_pass(design).noise_gain());
  const double Va = direct.at("airspeed").value[1000];
  EXPECT_NEAR(direct.at("sigma_airspeed").value[1000], SensorSigma{}.dynamic_pressure / (1.2 * Va) * left, 1e-9);
}

TEST(RecordedMotion, StandsForAReconstructionWithoutAFilter) {
  const aircraft::testing::MadeFlight flight = aircraft::testing::make_flight({.duration = 5.0});
  const Reconstruction whole = recorded_motion(flight.recording, data_sheet(), {});
  EXPECT_EQ(whole.filter, FilterKind::kNone);
  EXPECT_EQ(whole.sigma.alpha, SensorSigma{}.alpha);
  EXPECT_FALSE(whole.smoothed.has("wind_north"));
  const Recording few = aircraft::testing::without(
      flight.recording, {"beta", "roll", "pitch", "yaw", "vel_north", "vel_east", "vel_down", "accel_x"});
  const Reconstruction rest = recorded_motion(few, data_sheet(), {});
  EXPECT_EQ(rest.smoothed.at("airspeed").value, whole.smoothed.at("airspeed").value);
  EXPECT_FALSE(rest.smoothed.has("beta"));
  EXPECT_THAT(rest.warnings, ::testing::Contains(::testing::HasSubstr("beta is not recorded")));
}

TEST(DirectAirData, NeedsAPitotTube) {
  ReconstructOptions o = data_sheet();
  o.use_pitot = false;
  const Recording recording = aircraft::testing::make_flight({.duration = 2.0}).recording;
  EXPECT_EQ(why([&] { static_cast<void>(direct_air_data(recording, o, {})); }),
            "made flight: has neither dynamic pressure nor airspeed, which coefficients without a filter need "
            "(reconstruct.filter, track.air_data)");
}

}  // namespace
}  // namespace veridyn::aircraft
