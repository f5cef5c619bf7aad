#include "veridyn/vehicle/identification/drive_log.hpp"

#include <gtest/gtest.h>

#include "tests/vehicle/changed_drive.hpp"

namespace veridyn::vehicle {
namespace {

using testing::changed;
using testing::prepared;
using testing::recorded;

TEST(DriveLog, TakesWheelSpeedsInKilometresPerHourForThoseOfTheTread) {
  Recording log;
  const TimeBase time = make_time_base({0.0, 0.1});
  log.add(make_channel("wheel_speed_rl", "m/s", time, {10.0, 11.0}));
  log.add(make_channel("wheel_speed_rr", "rad/s", time, {30.0, 31.0}));
  log.add(make_channel("SteeringAngle", "rad", time, {0.1, 0.2}));  // of the hand wheel or the road wheels: left open
  log.add(make_channel("YawRate", "rad/s", time, {0.1, 0.2}));
  const recording::MappedRecording mapped = map_drive_channels(log, StudyTable("data.map"));
  EXPECT_EQ(mapped.recording.names(), (std::vector<std::string>{"wheel_speed_rr", "wheel_velocity_rl", "yaw_rate"}));
  EXPECT_EQ(mapped.origins[1].source, "wheel_speed_rl");
}

TEST(DriveLog, TurnsAFrdRecordingIntoFlu) {
  const Recording flu = recorded();
  Recording frd = flu;
  for (const char* name : {"steer", "yaw_rate", "accel_y"})
    frd = changed(frd, name, [](double, double v) { return -v; });
  frd.frame = Frame::kFrd;
  const DriveSignals a = prepared(flu), b = prepared(frd);
  for (const DriveSignal s : {DriveSignal::kSteer, DriveSignal::kYawRate, DriveSignal::kAccelY, DriveSignal::kSpeed})
    EXPECT_EQ(a[s].value, b[s].value);
  frd.frame = Frame::kUnspecified;
  const recording::MappedRecording by_study = map_drive_channels(frd, StudyTable(), "frd");
  EXPECT_EQ(prepare_drive_signals(by_study, {})[DriveSignal::kYawRate].value, a[DriveSignal::kYawRate].value);
  EXPECT_NE(why([&] { static_cast<void>(map_drive_channels(frd, StudyTable(), "ned")); }).find("'flu'"),
            std::string::npos);
}

}  // namespace
}  // namespace veridyn::vehicle
