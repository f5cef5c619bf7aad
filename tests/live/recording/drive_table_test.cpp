#include "veridyn/live/recording/drive_table.hpp"

#include <gtest/gtest.h>

#include "veridyn/io/log/log.hpp"
#include "veridyn/io/tables/csv.hpp"

namespace veridyn::live {
namespace {

Telemetry report(double time, double speed) {
  Telemetry t;
  t.sample.time = time;
  t.sample.speed = speed;
  t.sample.force = {1.0, -2.0, 9.81};
  t.sample.rate = {0.01, 0.02, 0.3};
  t.sample.inputs.steer = -0.1;
  t.sample.steer_from = recording::Origin::kMeasured;
  t.arrival = nanoseconds(time + 5.0);
  return t;
}

TEST(DriveTable, IsReadAsARecordingOfADrive) {
  DriveTable table;
  table.add(report(100.0, 1.5));
  table.add(report(100.01, 1.6));
  const std::string first = table.take_lines();
  table.add(report(100.02, 1.7));
  const Recording r = io::to_recording(io::read_csv(DriveTable::header() + first + table.take_lines(), "drive.csv"));
  EXPECT_EQ(r.frame, Frame::kFlu);
  const Channel& speed = r.at("speed");
  ASSERT_EQ(speed.size(), 3U);
  EXPECT_NEAR(speed.times()[2], 0.02, 1e-9);
  EXPECT_EQ(speed.value[2], 1.7);
  EXPECT_EQ(r.at("steer").value[0], -0.1);
  EXPECT_EQ(r.at("accel_y").value[1], -2.0);
  EXPECT_EQ(r.at("gyro_z").value[1], 0.3);
  EXPECT_EQ(table.rows(), 3U);
}

TEST(DriveTable, GoesOnWhereTheCarBeginsAgain) {
  DriveTable table;
  table.add(report(100.0, 1.5));
  Telemetry again = report(3.0, 0.0);
  again.restarted = true;
  again.arrival = nanoseconds(107.0);
  table.add(again);
  const Recording r = io::to_recording(io::read_csv(DriveTable::header() + table.take_lines(), "drive.csv"));
  EXPECT_NEAR(r.at("speed").times()[1], 2.0, 1e-6);  // the first one arrived at 105 s
}

}  // namespace
}  // namespace veridyn::live
