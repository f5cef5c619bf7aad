#include "veridyn/aircraft/reconstruction/reconstruct_run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/aircraft/reconstruction/reconstruct_flight.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"

namespace veridyn::aircraft::internal {
namespace {

/// A flight without noise, ready to be filtered.
struct ReadyFlight {
  ReadyFlight() {
    options.sensors = NoiseSource::kReference;
    streams = load_streams(made.recording, options);
    segment = find_segments(streams, 1.0).at(0);
    stamps = output_stamps(streams, {&segment, 1}, 10.0).time;
  }
  [[nodiscard]] RunSetting setting() const {
    return {.streams = &streams, .options = &options, .motion = {}, .output_t = &stamps};
  }
  aircraft::testing::MadeFlight made = aircraft::testing::make_flight(
      {.duration = 3.0, .spectrum = {200.0, 200.0, 50.0, 0.0, 0.0, 0.0}, .noise = false});
  ReconstructOptions options;
  FlightStreams streams;
  Segment segment;
  std::vector<double> stamps;
};

TEST(MedianWithin, IsThatOfTheSamplesInTheWindow) {
  Stream s;
  s.t = {0.0, 0.2, 0.4, 0.6, 2.0};
  s.v = {1.0, 9.0, 2.0, 3.0, 100.0};
  EXPECT_EQ(median_within(s, 0.1, 0.5), 3.0);  // of 9, 2, 3
  EXPECT_EQ(median_within(s, 2.0, 1.0), 100.0);
  EXPECT_TRUE(std::isnan(median_within(s, 0.7, 1.0)));
}

// Without gusts what is not airspeed is wind: the wind of the flight, at once.
TEST(StartOf, TakesTheWindFromAirspeedAndVanes) {
  const ReadyFlight flight;
  const Start start = start_of(flight.setting(), flight.segment);
  // The airspeed is the median over the first second, in which it grows by 0.3 m/s.
  EXPECT_LT((start.x.wind - Eigen::Vector3d(4.0, -3.0, 0.0)).norm(), 0.5);
  const Eigen::Vector3d air = start.x.attitude.conjugate() * (start.x.velocity - start.x.wind);
  EXPECT_NEAR(air.norm(), flight.made.airspeed.front(), 0.3);
  EXPECT_EQ(start.variance(AirDataErrorVector::kCore), 0.0) << "a bias that is not estimated is held";
  EXPECT_DOUBLE_EQ(start.variance(AirDataErrorVector::kVelocity),
                   flight.streams.sigma.velocity * flight.streams.sigma.velocity);
}

TEST(StartOf, TakesOffTheErrorsOfTheAirDataThatAreKnown) {
  const ReadyFlight flight;
  const Start plain = start_of(flight.setting(), flight.segment);
  RunSetting known = flight.setting();
  known.air_error(AirDataErrorVector::kPitotScale) = 0.21;  // of the pressure: 10 % of the airspeed
  const Start corrected = start_of(known, flight.segment);
  const auto airspeed = [](const Start& s) { return (s.x.velocity - s.x.wind).norm(); };
  EXPECT_NEAR(airspeed(corrected), airspeed(plain) / 1.1, 1e-9);
}

// Every sample comes once, at its stamp or the next event, in the order of the stamps; of those at one stamp the
// attitude first.
TEST(EventCursor, DeliversEverySampleOnceInOrder) {
  const ReadyFlight flight;
  EventCursor cursor(flight.streams, flight.stamps, flight.segment, 0);
  std::map<Sensor, std::size_t> delivered;
  std::size_t outputs = 0;
  double before = flight.segment.begin;
  for (double time = cursor.next_time(); std::isfinite(time); time = cursor.next_time()) {
    EXPECT_GE(time, before);
    before = time;
    int last = -1;
    cursor.step_to(time, [&](Sensor which, double value, double sigma) {
      EXPECT_GE(which, last);
      last = which;
      const Stream& stream = flight.streams.sensors[which];
      EXPECT_EQ(sigma, stream.sigma);
      const std::size_t number = delivered[which]++ + (which <= kVelDown ? 1 : 0);
      EXPECT_EQ(value, stream.v[number]) << which;
      EXPECT_LE(stream.t[number], time);
    });
    if (cursor.at_output()) {
      EXPECT_EQ(cursor.output(), outputs++);
    }
  }
  EXPECT_EQ(outputs, flight.stamps.size());
  // The first attitude and velocity started the run.
  EXPECT_EQ(delivered[kRoll], flight.streams.sensors[kRoll].t.size() - 1);
  EXPECT_EQ(delivered[kPitot], flight.streams.sensors[kPitot].t.size());
}

TEST(EventCursor, DoesNotTrustTheInertialSensorsAcrossMissingSamples) {
  ReadyFlight flight;
  const auto noise_at = [&flight](double time) {
    EventCursor cursor(flight.streams, flight.stamps, flight.segment, 0);
    AirDataInput u;
    for (double t = cursor.next_time(); t < time; t = cursor.next_time()) {
      cursor.fill(u, t, false);
      cursor.step_to(t, [](Sensor, double, double) {});
    }
    return u.imu_noise_factor;
  };
  EXPECT_EQ(noise_at(1.5), 1.0);
  auto& gyro = flight.streams.gyro;
  gyro.t.erase(gyro.t.begin() + 140, gyro.t.begin() + 160);
  gyro.v.erase(gyro.v.begin() + 140, gyro.v.begin() + 160);
  EXPECT_GT(noise_at(1.5), 1.0);
}

}  // namespace
}  // namespace veridyn::aircraft::internal
