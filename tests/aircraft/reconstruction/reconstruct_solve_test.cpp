#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/aircraft/reconstruction/reconstruct_flight.hpp"
#include "tests/aircraft/simulated_flight.hpp"
#include "veridyn/aircraft/reconstruction/air_data_likelihood.hpp"

namespace veridyn::aircraft::internal {
namespace {

TEST(EstimatedColumns, AreThoseOfTheOptions) {
  const FlightStreams streams = load_streams(aircraft::testing::make_flight({.duration = 2.0}).recording, {});
  const ColumnSet plain = estimated_columns({}, streams, false);
  EXPECT_EQ(std::count(plain.begin(), plain.end(), true), static_cast<std::ptrdiff_t>(kFirstImuBias));
  ReconstructOptions o;
  o.gyro_bias = o.pitot_scale = true;
  const ColumnSet some = estimated_columns(o, streams, true);
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    const std::string_view name = kColumns[c].name;
    const bool expected =
        c < kFirstImuBias || name.starts_with("gyro_bias") || name == "pitot_scale" || name.ends_with("_error");
    EXPECT_EQ(some[c], expected) << name;
  }
}

TEST(OutputStamps, LieOnWholeMultiplesOfThePeriodOrAtTheGyros) {
  FlightStreams s;
  for (int i = 0; i <= 100; ++i) s.gyro.t.push_back(0.013 + 0.01 * i);
  const std::array<Segment, 2> segments{{{0.03, 0.35}, {0.5, 0.71}}};
  const OutputStamps even = output_stamps(s, segments, 10.0);
  EXPECT_EQ(even.first, (std::vector<std::size_t>{0, 3}));
  ASSERT_EQ(even.time.size(), 6U);
  const std::array expected{0.1, 0.2, 0.3, 0.5, 0.6, 0.7};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_DOUBLE_EQ(even.time[i], expected[i]);
  const OutputStamps gyro = output_stamps(s, segments, 0.0);
  EXPECT_DOUBLE_EQ(gyro.time.front(), 0.033);
  EXPECT_DOUBLE_EQ(gyro.time[gyro.first[1]], 0.503);
}

TEST(ModelErrorOf, TakesACoefficientThatTheSubjectLacksForUnknown) {
  Subject subject = aircraft::testing::linear_unatrap();
  subject.model.coefficients[Coefficient::kCY].reset();
  ReconstructOptions o;
  o.model_error = {0.1, 0.2, 0.3};
  const ModelError error = model_error_of(subject, o);
  EXPECT_EQ(error.sigma(0), 0.1);
  EXPECT_EQ(error.sigma(1), 0.2);
  EXPECT_EQ(error.sigma(2), ModelError::kUnknownInitial);
  EXPECT_EQ(error.density(2), ModelError::kUnknownWalk);
}

// White noise of a sample every 10 ms as the square root of its power spectral density.
TEST(NoiseOf, IsTheSensorsPerRootHertz) {
  FlightStreams s;
  s.sigma.gyro = 0.02;
  s.sigma.accelerometer = 0.5;
  s.gyro.interval = s.accel.interval = 0.01;
  const AirDataNoise noise = noise_of(s, {});
  EXPECT_DOUBLE_EQ(noise.gyro, 0.002);
  EXPECT_DOUBLE_EQ(noise.accelerometer, 0.05);
}

// What is estimated of a vane is in the results at every stamp, with one sigma, and not in the model-free filter's
// states: the covariance is that of the check over the whole flight.
TEST(Solve, FillsErrorsOfTheAirDataAsConstants) {
  const Recording recording = aircraft::testing::make_flight({.duration = 30.0}).recording;
  ReconstructOptions o;
  o.sensors = NoiseSource::kReference;
  o.alpha_bias = true;
  const FlightStreams streams = load_streams(recording, o);
  const std::vector<Segment> segments = find_segments(streams, 1.0);
  const OutputStamps stamps = output_stamps(streams, segments, 10.0);
  const SolveTask task{.streams = &streams,
                       .options = &o,
                       .segments = segments,
                       .stamps = &stamps.time,
                       .first_stamp = stamps.first,
                       .spectrum = {200.0, 200.0, 50.0, 2.12, 2.12, 1.4},
                       .recording = &recording};
  Progress silent;
  const Solution solution = solve_model_free(task, silent);
  EXPECT_EQ(solution.count, stamps.time.size());
  ASSERT_EQ(solution.error_columns, std::vector<std::size_t>{kFirstAirDataError});
  const std::vector<double>& sigma = solution.smoothed->sigma(kFirstAirDataError);
  EXPECT_GT(sigma.front(), 0.0);
  EXPECT_LE(sigma.front(), air_data_error_priors()[0] * (1.0 + 1e-9));
  EXPECT_TRUE(std::ranges::all_of(sigma, [&](double s) { return s == sigma.front(); }));
  EXPECT_NEAR(solution.error_covariance(0, 0), sigma.front() * sigma.front(), 1e-15);
}

}  // namespace
}  // namespace veridyn::aircraft::internal
