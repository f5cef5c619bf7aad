#include "veridyn/aircraft/reconstruction/contradiction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/aircraft/reconstruction/reconstruct_flight.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;
using testing::MadeFlight;
using testing::make_flight;

const MadeFlight& sound_flight() {
  static const MadeFlight flight = make_flight({.duration = 80.0});
  return flight;
}

Recording with(const char* name, const std::function<double(double t, double v)>& change) {
  Recording recording = sound_flight().recording;
  Channel channel = recording.at(name);
  for (std::size_t i = 0; i < channel.size(); ++i) channel.value[i] = change(channel.times()[i], channel.value[i]);
  recording.set(std::move(channel));
  return recording;
}

Reconstruction reconstruction_of(const Recording& recording) {
  ReconstructOptions options;
  options.sensors = NoiseSource::kReference;
  options.turbulence = named_turbulence("low_moderate");
  Progress quiet;
  return reconstruct(recording, options, quiet);
}

double largest(const Recording& recording, const char* name) {
  double most = 0.0;
  if (const Channel* channel = recording.find(name))
    for (const double v : channel->value) most = std::max(most, std::abs(v));
  return most;
}

// Gravity taken off the specific force: by dead reckoning 80 s of it are 785 m/s.
TEST(Contradiction, OfAnAccelerometerWithoutGravityEndsTheReconstruction) {
  const Reconstruction r = reconstruction_of(with("accel_z", [](double, double v) { return v + kGravity; }));
  ASSERT_TRUE(r.contradiction.has_value());
  EXPECT_EQ(r.contradiction->channel, "vel_down");
  EXPECT_EQ(r.contradiction->against, "accelerometer and attitude");
  EXPECT_LT(r.contradiction->span.begin, 1.0);
  EXPECT_NEAR(r.contradiction->span.end, 10.0, 1.0);
  EXPECT_FALSE(r.interrupted);
  EXPECT_THAT(r.contradiction->statement, HasSubstr("vel_down contradicts accelerometer and attitude from 0."));
  // The error that it would take, g, to within what turns and the filter's pull take off.
  double off = 0.0;
  ASSERT_EQ(std::sscanf(r.contradiction->meaning.c_str(), "as if the accelerometer were off by %lf", &off), 1);
  EXPECT_NEAR(off, kGravity, 1.5);
  EXPECT_LT(largest(r.smoothed, "vel_down"), 20.0);
  EXPECT_LT(largest(r.filtered, "airspeed"), 30.0);
}

TEST(Contradiction, EndsTheResultsWhereItBegins) {
  const Reconstruction r =
      reconstruction_of(with("vel_north", [](double t, double v) { return t < 40.0 ? v : v + 3.0 * (t - 40.0); }));
  ASSERT_TRUE(r.contradiction.has_value());
  EXPECT_EQ(r.contradiction->channel, "vel_north");
  EXPECT_NEAR(r.contradiction->span.begin, 40.5, 1.0);
  const Channel& north = r.smoothed.at("vel_north");
  EXPECT_LT(north.times().back(), r.contradiction->span.begin);
  EXPECT_GT(north.times().back(), 39.0);
  const Reconstruction clean = reconstruction_of(sound_flight().recording);
  for (std::size_t i = 0; i < north.size(); i += 100)
    EXPECT_NEAR(north.value[i], clean.smoothed.at("vel_north").value[i], 0.5);
}

TEST(Contradiction, OfTheGyroIsWithTheAttitude) {
  const Reconstruction r = reconstruction_of(with("gyro_x", [](double, double v) { return v + 20.0 * kDegree; }));
  ASSERT_TRUE(r.contradiction.has_value());
  EXPECT_EQ(r.contradiction->channel, "roll");
  EXPECT_EQ(r.contradiction->against, "gyro");
  EXPECT_THAT(r.contradiction->statement, HasSubstr("deg/s"));
}

TEST(Contradiction, IsNoneInASoundFlightNorInAShortFaultOrDropout) {
  EXPECT_FALSE(reconstruction_of(sound_flight().recording).contradiction.has_value());
  const Reconstruction fault =
      reconstruction_of(with("vel_east", [](double t, double v) { return t > 30.0 && t < 36.0 ? v + 40.0 : v; }));
  EXPECT_FALSE(fault.contradiction.has_value());
  EXPECT_NEAR(fault.smoothed.at("airspeed").times().back(), 80.0, 0.1);
  const Reconstruction dropout =
      reconstruction_of(with("vel_east", [](double t, double v) { return t > 30.0 && t < 50.0 ? kNaN : v; }));
  EXPECT_FALSE(dropout.contradiction.has_value());
  // A vane that is wrong throughout is refused, but the gust model bounds what it measures.
  EXPECT_FALSE(reconstruction_of(with("alpha", [](double, double v) { return v + 1.5; })).contradiction.has_value());
}

TEST(Contradiction, WaitsForAsLongAsTheOptionsSay) {
  ReconstructOptions options;
  options.sensors = NoiseSource::kReference;
  options.turbulence = named_turbulence("low_moderate");
  options.gate.dead_reckoning_s = 30.0;
  Progress quiet;
  const Recording recording = with("accel_z", [](double, double v) { return v + kGravity; });
  const Reconstruction late = reconstruct(recording, options, quiet);
  ASSERT_TRUE(late.contradiction.has_value());
  EXPECT_NEAR(late.contradiction->span.end, 30.0, 1.0);
}

}  // namespace
}  // namespace veridyn::aircraft
