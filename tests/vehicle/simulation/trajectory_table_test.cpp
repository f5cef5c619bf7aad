#include "veridyn/vehicle/simulation/trajectory_table.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "veridyn/core/units.hpp"

namespace veridyn::vehicle {
namespace {

/// A trajectory of two samples whose every quantity holds a number of its own.
VehicleTrajectory numbered() {
  VehicleTrajectory t;
  t.time = {0.0, 0.1};
  double number = 0.0;
  for (const TrajectoryQuantity& q : trajectory_quantities()) t.*q.values = std::vector<double>(2, ++number);
  for (const WheelQuantity& q : wheel_quantities()) {
    for (std::vector<double>& of_wheel : t.*q.values) of_wheel.assign(2, ++number);
  }
  return t;
}

// A quantity that were there twice would have been written over.
TEST(TrajectoryTable, EveryQuantityIsAChannelOfItsOwnNumbers) {
  const Recording recording = to_recording(numbered());
  EXPECT_EQ(recording.frame, Frame::kFlu);
  std::set<std::string> names;
  double number = 0.0;
  const auto expect_channel = [&](const std::string& name, const char* unit) {
    const Channel& channel = recording.at(name);
    EXPECT_EQ(channel.value, std::vector<double>(2, ++number)) << name;
    EXPECT_EQ(channel.unit.dimension, parse_unit(unit).dimension) << name;
    EXPECT_EQ(parse_unit(unit).scale, 1.0) << name << " is in SI";
    EXPECT_TRUE(names.insert(name).second) << name;
  };
  for (const TrajectoryQuantity& q : trajectory_quantities()) expect_channel(q.name, q.unit);
  for (const WheelQuantity& q : wheel_quantities()) {
    for (const char* wheel : {"_fl", "_fr", "_rl", "_rr"}) expect_channel(std::string(q.name) + wheel, q.unit);
  }
  EXPECT_EQ(recording.channels().size(), names.size());
}

TEST(TrajectoryTable, LeavesOutWhatTheModelDoesNotHave) {
  VehicleTrajectory bicycle;
  bicycle.time = {0.0, 0.1};
  bicycle.r = {0.2, 0.3};
  const Recording recording = to_recording(bicycle);
  EXPECT_EQ(recording.names(), std::vector<std::string>{"yaw_rate"});
}

}  // namespace
}  // namespace veridyn::vehicle
