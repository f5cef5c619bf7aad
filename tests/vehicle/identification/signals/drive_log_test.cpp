#include "veridyn/vehicle/identification/signals/drive_log.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/temporary_folder.hpp"
#include "tests/vehicle/changed_drive.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/files.hpp"

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

// A car that leans a degree to the other side does not stand on its roof.
TEST(DriveLog, TakesTiltFromZeroToAWholeTurnAsAboutZero) {
  Recording log;
  const TimeBase time = make_time_base({0.0, 0.1, 0.2, 0.3});
  log.frame = Frame::kFlu;
  log.add(make_channel("roll", "rad", time, {359.0 * kDegree, 1.0 * kDegree, 350.0 * kDegree, 0.0}));
  log.add(make_channel("pitch", "rad", time, {0.01, -0.02, 3.0, -3.0}));
  log.add(make_channel("yaw", "rad", time, {6.0, 6.2, 0.1, 0.3}));
  const recording::MappedRecording mapped = map_drive_channels(log, StudyTable("data.map"));
  const std::vector<double>& roll = mapped.recording.at("roll").value;
  for (const auto& [k, degrees] : {std::pair{0, -1.0}, std::pair{1, 1.0}, std::pair{2, -10.0}, std::pair{3, 0.0}})
    EXPECT_NEAR(roll[k], degrees * kDegree, 1e-12);
  EXPECT_EQ(mapped.recording.at("pitch").value, log.at("pitch").value) << "within half a turn already";
  EXPECT_EQ(mapped.recording.at("yaw").value, log.at("yaw").value) << "a heading may be any";
  ASSERT_EQ(mapped.notes.size(), 1u);
  EXPECT_EQ(mapped.notes[0].find("roll: 2 readings"), 0u) << mapped.notes[0];
}

/// A drive of 20 s that turns at a constant rate.
std::string drive_table(const char* header, double yaw_rate) {
  std::string text = std::string(header) + "\n";
  for (int k = 0; k <= 200; ++k) text += fmt::format("{},{},{},{},{}\n", 0.1 * k, 0.01, 20, yaw_rate, 20 * yaw_rate);
  return text;
}

TEST(DriveLog, TakesRunsWithNamesFramesAndTimesOfTheirOwn) {
  const test::TemporaryFolder folder;
  write_file(folder.path() / "a.csv", drive_table("time,delta,u,r,ay", 0.1));
  write_file(folder.path() / "b.csv", drive_table("t,steer_rad,v,yawrate,lat", -0.2));
  write_file(folder.path() / "c.csv", drive_table("time,delta,u,r,ay", 0.3));
  const Study study = Study::parse(
      "[data]\nframe = 'flu'\nruns = ['a.csv']\nholdout_runs = ['c.csv']\n"
      "[data.map]\nsteer = { channel = 'delta', unit = 'rad' }\nspeed = { channel = 'u', unit = 'm/s' }\n"
      "yaw_rate = { channel = 'r', unit = 'rad/s' }\naccel_y = { channel = 'ay', unit = 'm/s^2' }\n"
      "[[data.run]]\nfile = 'b.csv'\nframe = 'frd'\nfrom = 5\nto = 15\nholdout = true\n"
      "map = { steer = { channel = 'steer_rad', unit = 'rad' }, speed = { channel = 'v', unit = 'm/s' }, yaw_rate = { "
      "channel = 'yawrate', unit = 'rad/s' }, accel_y = { channel = 'lat', unit = 'm/s^2' } }\n",
      "study.toml", folder.path());
  const DriveLog log = read_drive_log(study.root().table("data"));
  study.root().finish();
  ASSERT_EQ(log.runs.size(), 3U);
  EXPECT_NEAR(log.runs[0].duration(), 20.0, 1e-9);
  EXPECT_NEAR(log.runs[1].duration(), 10.0, 1e-9);
  ASSERT_EQ(log.holdout_runs.size(), 2U);
  EXPECT_EQ(log.holdout_runs[0].begin, log.runs[1].begin);
  EXPECT_EQ(log.inputs.size(), 3U);
  const Channel& yaw_rate = log.mapped.recording.at("yaw_rate");
  const auto at = [&](double t) {
    const auto stamps = yaw_rate.times();
    return yaw_rate.value[std::ranges::lower_bound(stamps, t - 1e-9) - stamps.begin()];
  };
  EXPECT_EQ(at(log.runs[0].begin), 0.1);
  EXPECT_EQ(at(log.runs[1].begin), 0.2) << "turned from frd";
  EXPECT_EQ(at(log.runs[2].begin), 0.3);
  EXPECT_EQ(log.mapped.recording.at("speed").value[0], 20.0);
}

TEST(DriveLog, RefusesRunsThatMakeNoSense) {
  const test::TemporaryFolder folder;
  write_file(folder.path() / "a.csv", drive_table("time,steer,speed,yaw_rate,accel_y", 0.1));
  const auto refusal = [&](const std::string& data) {
    const Study study = Study::parse("[data]\n" + data, "study.toml", folder.path());
    return why([&] { static_cast<void>(read_drive_log(study.root().table("data"))); });
  };
  EXPECT_NE(refusal("holdout_runs = ['a.csv']\n").find("leaves no recording to identify from"), std::string::npos);
  EXPECT_NE(refusal("runs = ['a.csv', 'a.csv']\n").find("data.runs: names"), std::string::npos);
  EXPECT_NE(refusal("[[data.run]]\nfrom = 3\n").find("data.run[0].file: is missing"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::vehicle
