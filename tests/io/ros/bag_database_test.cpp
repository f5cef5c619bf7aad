#include "veridyn/io/ros/bag_database.hpp"

#include <sqlite3.h>
#include <zstd.h>

#include "tests/io/support.hpp"
#include "tests/support/ros_writer.hpp"
#include "veridyn/io/read.hpp"

namespace veridyn::io {
namespace {

using testing::BagMessage;
using testing::BagTopic;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kRosBegin_ns;
using testing::message_of;
using testing::MessageWriter;

constexpr std::int64_t kMs_ns = 1'000'000;

std::vector<BagMessage> messages() {
  std::vector<BagMessage> all;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t ns = kRosBegin_ns + 10 * i * kMs_ns;
    all.push_back({1, ns + 2 * kMs_ns, testing::imu_message(ns, 0.01 * i, {0, 0, 0.1 * i}, {0, 0, 9.81})});
    all.push_back({2, ns + 3 * kMs_ns, MessageWriter().numbers(7.0F + static_cast<float>(i)).bytes()});
  }
  return all;
}

TEST(BagDatabase, OfOldDistributionsIsReadByTheStandardDefinitions) {
  const testing::TemporaryFolder folder;
  const auto path = folder.path() / "drive #1 50%.db3";
  testing::write_bag_database(path, {{1, "/imu", "sensor_msgs/msg/Imu"}, {2, "/own", "my_msgs/msg/Own"}}, messages());
  const Log log = read_log(path);
  EXPECT_EQ(log.format, "ROS 2 bag");
  EXPECT_EQ(log.frame, Frame::kFlu);
  ASSERT_EQ(log.count("imu"), 100U);
  EXPECT_EQ(log.find("imu")->find("angular_velocity.z")->value(99), 0.1 * 99);
  EXPECT_NEAR(log.find("imu")->time->back(), 0.988, 1e-9);
  EXPECT_THAT(log.damage.notes,
              ElementsAre("topics not decoded: own (my_msgs/msg/Own; the recording holds no definition of it)"));
  EXPECT_FALSE(log.damage.any());
}

TEST(BagDatabase, OfNewDistributionsIsReadByTheDefinitionsThatItHolds) {
  const testing::TemporaryFolder folder;
  const auto path = folder.path() / "drive.db3";
  testing::write_bag_database(
      path, {{1, "/imu", "sensor_msgs/msg/Imu"}, {2, "/own", "my_msgs/msg/Own", "float32 speed  # of mine\n"}},
      messages());
  const Log log = read_bag_database(path);
  EXPECT_EQ(log.find("own")->find("speed")->value(3), 10.0);
  EXPECT_EQ(log.count("imu"), 100U);
  const std::string bytes = read_file(path);
  EXPECT_EQ(read_bag_database(bytes, "x").count("own"), 100U) << "from memory";
}

TEST(BagDatabase, MayHoldCompressedMessages) {
  const testing::TemporaryFolder folder;
  std::vector<BagMessage> all = messages();
  for (BagMessage& m : all) {
    std::string packed(ZSTD_compressBound(m.payload.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), m.payload.data(), m.payload.size(), 1));
    m.payload = packed;
  }
  all.back().payload.resize(9);
  testing::write_bag_database(folder.path() / "d.db3",
                              {{1, "/imu", "sensor_msgs/msg/Imu"}, {2, "/v", "std_msgs/msg/Float32"}}, all);
  const Log log = read_bag_database(folder.path() / "d.db3");
  EXPECT_EQ(log.count("imu"), 100U);
  EXPECT_EQ(log.count("v"), 99U);
  EXPECT_EQ(log.damage.records_lost, 1U);
  EXPECT_THAT(log.damage.notes, Contains("1 messages that cannot be unpacked"));
}

// A recorder that was stopped leaves messages in the write-ahead log.
TEST(BagDatabase, IsReadWithItsWriteAheadLog) {
  const testing::TemporaryFolder folder;
  const auto path = folder.path() / "d.db3";
  testing::write_bag_database(path, {{1, "/v", "std_msgs/msg/Float32"}}, {});
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db, "PRAGMA journal_mode=wal; INSERT INTO messages VALUES(1, 1, 5000, x'000100000000803f')",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  const auto copy = folder.path() / "copy.db3";
  std::filesystem::copy_file(path, copy);
  std::filesystem::copy_file(path.string() + "-wal", copy.string() + "-wal");
  sqlite3_close(db);
  EXPECT_EQ(read_bag_database(copy).find("v")->fields.front().value(0), 1.0);
}

TEST(BagDatabase, RefusesOtherDatabasesInOneLine) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT(message_of([&] { (void)read_bag_database(folder.write("a.db3", "text")); }),
              HasSubstr("is no SQLite database"));
  const auto path = folder.path() / "other.db3";
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(db,
                         "CREATE TABLE topics(id, name, type, serialization_format); CREATE VIEW messages AS WITH "
                         "RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i+1 FROM n) SELECT i AS topic_id, i AS "
                         "timestamp, i AS data FROM n",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(db);
  EXPECT_THAT(message_of([&] { (void)read_log(path); }), HasSubstr("is an SQLite database, but no bag of ROS 2"))
      << "a view that never ends";
  std::string cut;
  testing::write_bag_database(path, {{1, "/imu", "sensor_msgs/msg/Imu"}}, messages());
  cut = read_file(path).substr(0, 600);
  EXPECT_THAT(message_of([&] { (void)read_log(folder.write("cut.db3", cut)); }), HasSubstr("cut.db3: is"));
}

TEST(BagDatabase, StandsDamage) {
  const testing::TemporaryFolder folder;
  testing::write_bag_database(folder.path() / "d.db3",
                              {{1, "/imu", "sensor_msgs/msg/Imu"}, {2, "/v", "std_msgs/msg/Float32"}}, messages());
  const std::string whole = read_file(folder.path() / "d.db3");
  std::size_t read = 0, noticed = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    std::string bytes = testing::flip_bits(whole, seed);
    if (seed % 4 == 0) bytes.resize(bytes.size() * (seed % 100) / 100);
    try {
      const Log log = read_bag_database(bytes, "x");
      testing::expect_consistent(log, bytes.size());
      ++read;
      noticed += log.damage.any() ? 1U : 0U;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      ++noticed;
    }
  }
  EXPECT_GT(read, 100U);
  EXPECT_GT(noticed, 50U);
}

}  // namespace
}  // namespace veridyn::io
