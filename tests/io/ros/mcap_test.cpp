#include "veridyn/io/ros/mcap.hpp"

#include <cmath>

#include "tests/io/ros/mcap_by_others.hpp"
#include "tests/io/support.hpp"
#include "tests/support/ros_writer.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/io/read.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kRosBegin_ns;
using testing::McapWriter;
using testing::message_of;
using testing::MessageWriter;

TEST(Mcap, IsReadAsOthersWriteIt) {
  const Log log = read_mcap(testing::from_base64(testing::kMcapByOthers), "x.mcap");
  EXPECT_FALSE(log.damage.any());
  EXPECT_THAT(log.damage.notes, IsEmpty());
  const LogTopic& imu = *log.find("imu/data");
  ASSERT_EQ(imu.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const double k = static_cast<double>(i);
    EXPECT_NEAR((*imu.time)[i], 0.01 * k - 0.002, 1e-9) << "from when the first message was logged";
    EXPECT_EQ(imu.find("orientation.x")->value(i), 0.1 * k);
    EXPECT_EQ(imu.find("orientation.w")->value(i), 0.9);
    EXPECT_EQ(imu.find("angular_velocity.x")->value(i), 0.25 * k);
    EXPECT_EQ(imu.find("angular_velocity.z")->value(i), 2.5);
    EXPECT_EQ(imu.find("linear_acceleration.y")->value(i), 0.125 * k);
    EXPECT_EQ(log.find("joints")->find("velocity[left]")->value(i), 10.5 + k);
    EXPECT_EQ(log.find("joints")->find("velocity[right]")->value(i), -11.25);
  }
  EXPECT_EQ(log.information.at("imu/data.orientation_covariance"), "1 2 3 4 5 6 7 8 9");
  const LogTopic& fix = *log.find("fix");
  ASSERT_EQ(fix.size(), 2U);
  EXPECT_EQ(fix.find("latitude")->value(1), 49.25);
  EXPECT_EQ(fix.find("altitude")->value(1), 512.125);
  const Recording recording = to_recording(log);
  EXPECT_NEAR(recording.at("fix.longitude").value[0], -8.5 * kDegree, 1e-15);
}

TEST(Mcap, IsReadWholeWhateverItsChunksAreCompressedBy) {
  const Log log = read_mcap(testing::small_mcap(), "x.mcap");
  EXPECT_FALSE(log.damage.any());
  EXPECT_EQ(log.format, "MCAP");
  EXPECT_EQ(log.frame, Frame::kFlu);
  EXPECT_EQ(log.count("imu/data"), 150U);
  EXPECT_EQ(log.count("odom"), 150U);
  EXPECT_EQ(log.count("fix"), 15U);
  EXPECT_EQ(log.count("drive"), 75U);
  EXPECT_EQ(log.find("odom")->find("twist.twist.linear.x")->value(149), 10.0 + 0.02 * 149);
  EXPECT_EQ(log.find("joint_states")->find("velocity[rear_left_wheel]")->value(1), 30.04);
  EXPECT_EQ(log.information.at("child frame of odom"), "base_link");
  EXPECT_THAT(log.damage.notes, ElementsAre("topics not decoded: note (; its messages are in json)"));
  EXPECT_NEAR(log.find("throttle")->time->front(), 0.001, 1e-9) << "when it was logged: it has no stamp";
}

TEST(Mcap, IsReadWithoutChunksAndWithoutASummary) {
  McapWriter writer;
  writer.schema(9, "std_msgs/msg/Float32", "ros2msg", "float32 data");
  writer.channel(3, 9, "/v");
  for (int i = 0; i < 10; ++i) writer.message(3, kRosBegin_ns + i * 1'000'000LL, MessageWriter().number(0.5F).bytes());
  const Log log = read_mcap(writer.bytes(), "x");
  EXPECT_EQ(log.count("v"), 10U);
  EXPECT_THAT(log.damage.notes, Contains(HasSubstr("ends without a footer")));
}

TEST(Mcap, ReadsMessagesOfRos1) {
  McapWriter writer("ros1");
  writer.schema(
      1, "my_msgs/Speed", "ros1msg",
      "Header header\nfloat64 v\n====================\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id");
  writer.channel(1, 1, "/speed", "ros1");
  writer.message(1, kRosBegin_ns + 5'000'000,
                 MessageWriter(MessageWriter::Kind::kRos1).header(kRosBegin_ns, "car").number(7.5).bytes());
  writer.finish();
  const Log log = read_mcap(writer.bytes(), "x");
  EXPECT_EQ(log.find("speed")->find("v")->value(0), 7.5);
  EXPECT_NEAR(log.find("speed")->time->front(), -0.005, 1e-9);
}

TEST(Mcap, IsReadAsFarAsItGoesWhereItIsCutOff) {
  const std::string whole = testing::small_mcap();
  std::size_t before = 0;
  // Three quarters of the file are a chunk without compression, which can be read in part; then come two others.
  for (const double share : {0.2, 0.5, 0.7, 0.8, 0.9, 1.0}) {
    const auto size = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
    const Log log = read_mcap(std::string_view(whole).substr(0, size), "x");
    EXPECT_GT(log.count("imu/data"), before) << share;
    before = log.count("imu/data");
  }
}

TEST(Mcap, LeavesOutAChunkWithAWrongChecksum) {
  McapWriter writer;
  writer.schema(1, "std_msgs/msg/Float64", "ros2msg", "float64 data");
  writer.channel(1, 1, "/v");
  for (int chunk = 0; chunk < 3; ++chunk) {
    writer.begin_chunk();
    for (int i = 0; i < 5; ++i)
      writer.message(1, kRosBegin_ns + (5 * chunk + i) * 1'000'000LL, MessageWriter().number(1.0 * chunk).bytes());
    writer.end_chunk("zstd", chunk == 1 ? 12345U : 0U);
  }
  writer.finish();
  const Log log = read_mcap(writer.bytes(), "x");
  EXPECT_EQ(log.count("v"), 10U);
  EXPECT_EQ(log.find("v")->fields.front().value(5), 2.0);
  EXPECT_EQ(log.damage.records_lost, 5U);
  EXPECT_THAT(log.damage.notes, Contains("1 chunks with a wrong checksum"));
  EXPECT_THAT(log.damage.notes, Contains("5 messages of 15 that its summary counts are missing"));
}

TEST(Mcap, GoesOnAfterDamage) {
  std::string bytes = testing::small_mcap();
  const std::size_t second = bytes.find("lz4");
  ASSERT_NE(second, std::string::npos);
  // The length of the second chunk: nothing leads on from there.
  for (std::size_t i = 0; i < 8; ++i) bytes[second - 41 + i] = static_cast<char>(0x5a);
  const Log log = read_mcap(bytes, "x");
  EXPECT_EQ(log.count("imu/data"), 100U);
  EXPECT_GE(log.damage.records_lost, 1U);
  EXPECT_GT(log.damage.bytes_lost, 1000U);
}

TEST(Mcap, RefusesWhatItIsNotInOneLine) {
  EXPECT_EQ(message_of([] { (void)read_mcap("", "x"); }), "x: the file is empty");
  EXPECT_THAT(message_of([] { (void)read_mcap("\x89MCAP9\r\n", "x"); }),
              HasSubstr("not an MCAP recording of version 0"));
  EXPECT_THAT(message_of([] { (void)read_mcap("\x89MCAP0\r\n", "x"); }), HasSubstr("holds no messages"));
  McapWriter large;
  large.record(6, std::string(16, '\0') + std::string("\0\0\0\0\0\1\0\0", 8) + std::string(4, '\0') +
                      McapWriter::text("zstd") + std::string(8, '\0'));
  large.finish();
  EXPECT_THAT(message_of([&] { (void)read_mcap(large.bytes(), "x"); }), HasSubstr("more than 256 MiB"));
}

// A file of some kilobytes may not keep a computer busy for minutes.
TEST(Mcap, UnpacksNoMoreThanAHundredTimesItsSize) {
  McapWriter bomb;
  bomb.schema(1, "std_msgs/msg/Float64", "ros2msg", "float64 data");
  bomb.channel(1, 1, "/v");
  bomb.message(1, kRosBegin_ns, MessageWriter().number(1.0).bytes());
  const std::size_t before = bomb.bytes().size();
  bomb.begin_chunk();
  bomb.bytes().assign(32U << 20U, '\0');
  bomb.end_chunk("zstd", 1);
  const std::string chunk = bomb.bytes().substr(before);
  for (int i = 0; i < 20; ++i) bomb.bytes() += chunk;
  bomb.finish();
  EXPECT_LT(bomb.bytes().size(), 200'000U);
  const Log log = read_mcap(bomb.bytes(), "x");
  EXPECT_EQ(log.count("v"), 1U);
  EXPECT_THAT(log.damage.notes,
              Contains(HasSubstr("chunks that cannot be unpacked: together with the others more than")));
}

TEST(Mcap, IsRecognisedByItsContent) {
  const testing::TemporaryFolder folder;
  const Log log = read_log(folder.write("drive.bin", testing::small_mcap()));
  EXPECT_EQ(log.format, "MCAP");
  EXPECT_EQ(log.count("imu/data"), 150U);
}

}  // namespace
}  // namespace veridyn::io
