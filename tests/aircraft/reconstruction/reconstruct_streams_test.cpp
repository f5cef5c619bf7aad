#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/reconstruction/reconstruct_flight.hpp"
#include "tests/aircraft/simulated_flight.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft::internal {
namespace {

using ::testing::HasSubstr;

Recording quiet_flight(double duration = 10.0) {
  return aircraft::testing::make_flight({.duration = duration, .noise = false}).recording;
}

ReconstructOptions reference() {
  ReconstructOptions o;
  o.sensors = NoiseSource::kReference;
  return o;
}

TEST(FlightStreams, HoldFiniteSamplesAtStampsWithoutTheirDelay) {
  Recording recording = quiet_flight();
  Channel alpha = recording.at("alpha");
  alpha.value[3] = kNaN;
  const std::size_t before = alpha.size();
  recording.set(std::move(alpha));
  ReconstructOptions o = reference();
  o.delay.alpha = 0.07;
  const FlightStreams s = load_streams(recording, o);
  EXPECT_EQ(s.sensors[kAlpha].t.size(), before - 1);
  EXPECT_DOUBLE_EQ(s.sensors[kAlpha].t[3], recording.at("alpha").times()[4] - 0.07);
  EXPECT_EQ(s.sensors[kBeta].t[3], recording.at("beta").times()[3]) << "the other vane has no delay";
  EXPECT_NEAR(s.sensors[kVelNorth].rate_Hz, 20.0, 1e-6);
  EXPECT_DOUBLE_EQ(s.sensors[kAlpha].sigma, 0.6 * kDegree);
  EXPECT_TRUE(s.sensors[kAccelX].t.empty()) << "the model-free filter has the accelerometer as its input";
}

TEST(FlightStreams, LeaveOutTheSensorsThatAreNotToBeUsed) {
  ReconstructOptions o = reference();
  o.use_alpha = o.use_pitot = false;
  const FlightStreams s = load_streams(quiet_flight(), o);
  EXPECT_TRUE(s.sensors[kAlpha].t.empty());
  EXPECT_TRUE(s.sensors[kPitot].t.empty());
  EXPECT_FALSE(s.sensors[kBeta].t.empty());
}

TEST(FlightStreams, AreLinearBetweenSamples) {
  const FlightStreams s = load_streams(quiet_flight(), reference());
  std::size_t cursor = 0;
  const Eigen::Vector3d middle = s.gyro.at(0.5 * (s.gyro.t[10] + s.gyro.t[11]), cursor);
  EXPECT_LT((middle - 0.5 * (s.gyro.v[10] + s.gyro.v[11])).norm(), 1e-12);
  EXPECT_EQ(cursor, 10U);
  EXPECT_EQ(s.gyro.at(1e6, cursor), s.gyro.v.back()) << "constant beyond the last sample";
}

// A gap of 3 s in the gyro parts the flight; what is left behind it must have an attitude and a velocity to start from.
TEST(FindSegments, PartsTheFlightAtAGapOfGyroOrAccelerometer) {
  Recording recording = quiet_flight();
  for (const char* name : {"gyro_x", "gyro_y", "gyro_z"}) {
    Channel channel = recording.at(name);
    for (std::size_t i = 0; i < channel.size(); ++i)
      if (channel.times()[i] > 4.0 && channel.times()[i] < 7.0) channel.value[i] = kNaN;
    recording.set(std::move(channel));
  }
  const FlightStreams s = load_streams(recording, reference());
  const std::vector<Segment> parts = find_segments(s, 1.0);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_NEAR(parts[0].end, 4.0, 0.011);
  EXPECT_NEAR(parts[1].begin, 7.0, 0.051) << "with the first velocity, which comes every 50 ms";
  EXPECT_EQ(find_segments(s, 5.0).size(), 1U) << "a gap that is allowed";
}

TEST(FindSegments, LeavesOutWhatIsTooShortToEstimateFrom) {
  EXPECT_TRUE(find_segments(load_streams(quiet_flight(0.9), reference()), 1.0).empty());
}

TEST(LoadStreams, NamesWhatIsMissing) {
  const Recording whole = quiet_flight(2.0);
  const auto without = [&whole](const std::string& name) {
    Recording recording;
    recording.source = whole.source;
    for (const Channel& c : whole.channels())
      if (c.name != name) recording.add(c);
    return why([&] { static_cast<void>(load_streams(recording, reference())); });
  };
  EXPECT_THAT(without("gyro_y"), HasSubstr("gyro_y"));
  for (const char* name : {"yaw", "vel_north", "accel_z", "alpha"})
    EXPECT_EQ(without(name), "nothing was refused") << name << " need not be there";
}

TEST(LoadModelStreams, NameTheKeyThatNeedsWhatIsMissing) {
  const Recording recording = quiet_flight(2.0);
  const std::string message = why([&] {
    static_cast<void>(load_model_streams(recording, aircraft::testing::linear_unatrap(),
                                         load_streams(recording, reference()), "track.filter = \"guarded\""));
  });
  EXPECT_THAT(message, HasSubstr("track.filter = \"guarded\""));
  EXPECT_THAT(message, HasSubstr("elevator"));
}

// An accelerometer 0.4 m in front of the centre of gravity of an aircraft that turns shows the centripetal force too.
TEST(LoadModelStreams, MoveTheAccelerometerToTheCentreOfGravity) {
  const aircraft::testing::Flown flown = aircraft::testing::fly({.duration = 5.0});
  Subject away = flown.subject;
  away.imu_position = {0.4, 0.0, 0.0};
  const FlightStreams plain = load_streams(flown.measured, aircraft::testing::reference_options());
  const ModelStreams at_sensor = load_model_streams(flown.measured, flown.subject, plain);
  const ModelStreams moved = load_model_streams(flown.measured, away, plain);
  const std::size_t i = at_sensor.streams.accel.v.size() / 2;
  std::size_t cursor = 0;
  const Eigen::Vector3d w = plain.gyro.at(at_sensor.streams.accel.t[i], cursor);
  const double change = moved.streams.accel.v[i].x() - at_sensor.streams.accel.v[i].x();
  // -(w x (w x r)) of r along x; w' x r has no part along x.
  EXPECT_NEAR(change, 0.4 * (w.y() * w.y() + w.z() * w.z()), 1e-12);
  EXPECT_EQ(moved.streams.sensors[kAccelX].v.size(), moved.streams.accel.v.size());
  EXPECT_FALSE(moved.force_model.model.find(Coefficient::kCm)) << "moments are not used";
}

}  // namespace
}  // namespace veridyn::aircraft::internal
