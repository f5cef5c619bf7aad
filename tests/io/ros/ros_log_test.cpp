#include "veridyn/io/ros/ros_log.hpp"

#include <cmath>

#include "tests/io/support.hpp"
#include "tests/support/ros_writer.hpp"

namespace veridyn::io::internal {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kRosBegin_ns;
using testing::MessageWriter;

constexpr Nanoseconds kMillisecond = 1'000'000;

Log finished(RosLog& messages) {
  Log log;
  log.source = "x";
  messages.finish(log);
  return log;
}

RosTopic standard(const char* name, const char* type) { return {name, type, "cdr", "", ""}; }

TEST(RosLog, GivesTimesFromTheFirstMessageByTheMessagesOwnStamps) {
  RosLog messages;
  const std::size_t imu = messages.topic(standard("/imu", "sensor_msgs/msg/Imu")),
                    plain = messages.topic(standard("/v", "std_msgs/msg/Float64"));
  EXPECT_EQ(messages.topic(standard("/imu", "sensor_msgs/msg/Imu")), imu) << "described again";
  messages.add(plain, kRosBegin_ns, MessageWriter().number(2.5).bytes());
  for (int i = 0; i < 3; ++i)
    messages.add(imu, kRosBegin_ns + (10 * i + 4) * kMillisecond,
                 testing::imu_message(kRosBegin_ns + 10 * i * kMillisecond, 0.5, {0, 0, 0.1 * i}, {0, 0, 9.81}));
  const Log log = finished(messages);
  const LogTopic& topic = *log.find("imu");
  ASSERT_EQ(topic.size(), 3U);
  EXPECT_NEAR((*topic.time)[2], 0.02, 1e-9);
  EXPECT_EQ(topic.find("angular_velocity.z")->unit, "rad/s");
  EXPECT_EQ(topic.find("angular_velocity.z")->value(2), 0.2);
  EXPECT_EQ(log.find("v")->fields.front().name, "");
  EXPECT_EQ(log.information.at("type of imu"), "sensor_msgs/msg/Imu");
  EXPECT_EQ(log.information.at("frame of imu"), "base_link");
  EXPECT_EQ(log.information.at("date"), "2023-11-14");
  EXPECT_EQ(log.information.at("imu.orientation_covariance"), "0.01 0.01 0.01 0.01 0.01 0.01 0.01 0.01 0.01");
}

TEST(RosLog, SaysWhatItCannotDecode) {
  RosLog messages;
  messages.add(messages.topic({"/a", "foxglove.Pose", "protobuf", "protobuf", "x"}), 0, "");
  messages.add(messages.topic(standard("/b", "my_msgs/msg/Own")), 0, "");
  messages.add(messages.topic({"/c", "my_msgs/msg/Own", "cdr", "ros2idl", "x"}), 0, "");
  messages.add(messages.topic({"/d", "my_msgs/msg/Own", "cdr", "ros2msg", "wstring x"}), 0, "");
  EXPECT_EQ(testing::message_of([&] { (void)finished(messages); }),
            "x: holds no messages that can be read; topics not decoded: a (foxglove.Pose; its messages are in "
            "protobuf), b (my_msgs/msg/Own; the recording holds no definition of it), c (my_msgs/msg/Own; its "
            "definition is in ros2idl), d (my_msgs/msg/Own; its definition cannot be understood)");
  RosLog others;
  others.add(others.topic(standard("/v", "std_msgs/msg/Float64")), 0, MessageWriter().number(2.5).bytes());
  others.add(others.topic({"/a\nb", "T", "json", "", ""}), 0, "{}");
  EXPECT_THAT(finished(others).damage.notes, ElementsAre("topics not decoded: a?b (T; its messages are in json)"));
}

TEST(RosLog, HasNothingWhereAMessageSaysThatItHoldsNone) {
  RosLog messages;
  const std::size_t imu = messages.topic(standard("imu", "sensor_msgs/msg/Imu")),
                    fix = messages.topic(standard("fix", "sensor_msgs/msg/NavSatFix"));
  for (int i = 0; i < 3; ++i) {
    MessageWriter m;
    m.header(kRosBegin_ns + i * kMillisecond, "").reals({0, 0, 0, 1}).reals({-1, 0, 0, 0, 0, 0, 0, 0, 0});
    m.reals({1, 2, 3})
        .reals(std::vector<double>(9, 0.0))
        .reals({4, 5, 6})
        .reals({i == 1 ? -1.0 : 0.0, 0, 0, 0, 0, 0, 0, 0, 0});
    messages.add(imu, kRosBegin_ns + i * kMillisecond, m.bytes());
    MessageWriter f;
    f.header(kRosBegin_ns + i * kMillisecond, "").numbers(static_cast<std::int8_t>(i - 1), std::uint16_t{1});
    f.reals({47.0, 8.0, 400.0}).reals(std::vector<double>(9, 0.0)).number(std::uint8_t{0});
    messages.add(fix, kRosBegin_ns + i * kMillisecond, f.bytes());
  }
  const Log log = finished(messages);
  const LogTopic& topic = *log.find("imu");
  EXPECT_EQ(topic.find("orientation.w"), nullptr);
  EXPECT_EQ(topic.find("angular_velocity.x")->value(1), 1.0);
  EXPECT_TRUE(std::isnan(topic.find("linear_acceleration.z")->value(1)));
  EXPECT_EQ(topic.find("linear_acceleration.z")->value(2), 6.0);
  EXPECT_TRUE(std::isnan(log.find("fix")->find("latitude")->value(0))) << "no fix";
  EXPECT_EQ(log.find("fix")->find("latitude")->value(1), 47.0);
}

TEST(RosLog, KeepsTheStaticTransforms) {
  RosLog messages;
  const std::size_t tf = messages.topic({"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", "ros2msg", "x"}),
                    v = messages.topic(standard("/v", "std_msgs/msg/Float64"));
  for (const auto kind : {MessageWriter::Kind::kLittleEndian, MessageWriter::Kind::kBigEndian}) {
    MessageWriter m(kind);
    m.number(std::uint32_t{2});
    m.header(0, "base_link").text("imu_link").reals({1, 2, 3, 1, 0, 0, 0});
    m.header(0, "base_link").text("gps").reals({0.5, 0, 1, 0, 0, 0, 1});
    messages.add(tf, 0, m.bytes());
    messages.add(v, 0, MessageWriter().number(2.5).bytes());
    const Log log = finished(messages);
    EXPECT_EQ(log.information.at("transform base_link to imu_link"), "1 2 3 1 0 0 0");
    EXPECT_EQ(log.information.at("transform base_link to gps"), "0.5 0 1 0 0 0 1");
    (void)messages.topic({"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", "ros2msg", "x"});
    (void)messages.topic(standard("/v", "std_msgs/msg/Float64"));
  }
}

TEST(RosLog, NotesStampsOfAnotherClockAndMessagesWithoutAStamp) {
  RosLog messages;
  const std::size_t imu = messages.topic(standard("imu", "sensor_msgs/msg/Imu"));
  for (int i = 0; i < 40; ++i)
    messages.add(
        imu, kRosBegin_ns + 10 * i * kMillisecond,
        testing::imu_message(i % 2 == 0 ? 0 : 5'000 * kMillisecond + 10 * i * kMillisecond, 0, {0, 0, 0}, {0, 0, 9.8}));
  const Log log = finished(messages);
  EXPECT_NEAR(log.find("imu")->time->back(), 0.39, 1e-6);
  EXPECT_THAT(log.damage.notes, Contains(HasSubstr("stamps on another clock than the log's, moved so that the least "
                                                   "delay is none: imu (1.7e+09 s away)")));
  EXPECT_THAT(log.damage.notes,
              Contains("messages without a stamp, which have the time at which they were logged: 20 of imu"));
}

// A simulation recorded by its own clock, which is reset.
TEST(RosLog, GoesOnWhereTheLogsClockRestarts) {
  RosLog messages;
  const std::size_t v = messages.topic(standard("v", "std_msgs/msg/Float64"));
  for (int i = 0; i < 200; ++i)
    messages.add(v, ((i < 100 ? 100'000 : 0) + 20 * (i % 100)) * kMillisecond, MessageWriter().number(1.0 * i).bytes());
  const Log log = finished(messages);
  const LogTopic& topic = *log.find("v");
  ASSERT_EQ(topic.size(), 200U);
  EXPECT_EQ(topic.fields.front().value(150), 150.0);
  EXPECT_NEAR((*topic.time)[100], 1.98 + kRestartPause_s, 1e-6);
  EXPECT_THAT(log.restarts, ElementsAre(::testing::DoubleNear(1.98 + kRestartPause_s, 1e-6)));
}

// As converters write them.
TEST(RosLog, TakesTopicsThatStandOneAfterTheOther) {
  RosLog messages;
  for (const char* name : {"a", "b"}) {
    const std::size_t topic = messages.topic(standard(name, "std_msgs/msg/Float64"));
    for (int i = 0; i < 200; ++i)
      messages.add(topic, 500LL * i * kMillisecond, MessageWriter().number(1.0 * i).bytes());
  }
  const Log log = finished(messages);
  EXPECT_TRUE(log.restarts.empty());
  EXPECT_EQ(*log.find("a")->time, *log.find("b")->time);
}

TEST(RosLog, CallsWhatPx4SendsAsItsULogsDo) {
  RosLog messages;
  const std::size_t attitude = messages.topic({"/fmu/out/vehicle_attitude_v1", "px4_msgs/msg/VehicleAttitude", "cdr",
                                               "ros2msg", "uint64 timestamp\nfloat32[4] q\n"}),
                    pressure = messages.topic({"/fmu/out/vehicle_air_data", "px4_msgs/msg/VehicleAirData", "cdr",
                                               "ros2msg", "uint64 timestamp\nfloat32 baro_pressure_pa\n"});
  for (std::uint64_t i = 0; i < 20; ++i) {
    const std::uint64_t us = 7'000'000 + 4000 * i;
    messages.add(attitude, kRosBegin_ns + static_cast<Nanoseconds>(4 * i + i % 2) * kMillisecond,
                 MessageWriter().numbers(us, 1.0F, 0.1F * static_cast<float>(i), 0.0F, 0.0F).bytes());
    messages.add(pressure, kRosBegin_ns + static_cast<Nanoseconds>(4 * i + i % 2) * kMillisecond,
                 MessageWriter().numbers(us, 95000.0F + static_cast<float>(i)).bytes());
  }
  const Log log = finished(messages);
  EXPECT_EQ(log.frame, Frame::kFrd);
  const Recording recording = to_recording(log);
  EXPECT_NEAR(recording.at("vehicle_attitude.q[1]").value[3], 0.3, 1e-7);
  EXPECT_NEAR(recording.at("vehicle_attitude.q[1]").times()[3], 0.012, 1e-9) << "on the log's clock";
  EXPECT_EQ(recording.at("vehicle_air_data.baro_pressure_pa").recorded_unit, "Pa");
}

TEST(OneLine, MakesTextsFitToBePrinted) { EXPECT_EQ(one_line("a\nb\tc\x01\xff", 5), "a?b?c"); }

}  // namespace
}  // namespace veridyn::io::internal
