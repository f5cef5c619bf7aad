#include "veridyn/aircraft/sensors/accelerometer_at_centre.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

constexpr std::array<double, 3> kAhead{1.0, 0.1, -0.3};

/// A calm flight; its accelerometer ahead of the centre of gravity, or in it.
FlightStudy flown(const std::array<double, 3>& position, std::string_view sensors) {
  Progress silent;
  return read_study(
      Study::parse(fmt::format("seed = 3\n[subject]\nbuiltin = \"unatrap\"\nimu_position = [{}, {}, {}]\n[flight]\n"
                               "duration = 120\naltitude = 300\nturbulence = \"none\"\n[sensors]\nset = \"{}\"\n",
                               position[0], position[1], position[2], sensors),
                   "ahead.toml"),
      silent);
}

double rms_difference(const Channel& a, const Channel& b) {
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!std::isfinite(a.value[k]) || !std::isfinite(b.value[k])) continue;
    sum += std::pow(a.value[k] - b.value[k], 2.0);
    count += 1.0;
  }
  EXPECT_GT(count, 1000.0);
  return std::sqrt(sum / count);
}

TEST(AccelerometerAtCentre, ShowsWhatOneInTheCentreOfGravityDoes) {
  const Recording ahead = flown(kAhead, "perfect").mapped.recording;
  const Recording centre = flown({0.0, 0.0, 0.0}, "perfect").mapped.recording;
  const Recording moved = with_accelerometer_at_centre(ahead, kAhead);
  for (const char* name : {"accel_x", "accel_y", "accel_z"}) {
    const double before = rms_difference(ahead.at(name), centre.at(name));
    EXPECT_GT(before, 0.05) << name;
    EXPECT_LT(rms_difference(moved.at(name), centre.at(name)), 0.15 * before) << name;
  }
}

TEST(AccelerometerAtCentre, IsAsItIsWithoutAPlaceOrWithoutAGyro) {
  const Recording ahead = flown(kAhead, "perfect").mapped.recording;
  EXPECT_EQ(with_accelerometer_at_centre(ahead, {0.0, 0.0, 0.0}).at("accel_y").value, ahead.at("accel_y").value);
  Recording alone;
  for (const char* name : {"accel_x", "accel_y", "accel_z"}) alone.add(ahead.at(name));
  EXPECT_EQ(with_accelerometer_at_centre(alone, kAhead).at("accel_y").value, ahead.at("accel_y").value);
}

// It was said to contradict velocity and attitude, as where axes are turned: y read 0.8 times the truth.
TEST(AccelerometerAtCentre, OfAStatedPlaceDoesNotContradictTheVelocity) {
  Progress silent;
  const FlightAnalysis analysis = identify(flown(kAhead, "reference"), silent);
  std::size_t rows = 0;
  for (const estimation::Evidence& row : analysis.flights.front().recording_evidence) {
    if (row.check != estimation::Check::kSensorGain) continue;
    ++rows;
    EXPECT_TRUE(row.passed()) << row.about;
  }
  EXPECT_GT(rows, 0U);
}

}  // namespace
}  // namespace veridyn::aircraft
