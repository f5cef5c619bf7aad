#include "veridyn/io/ros/bag_folder.hpp"

#include "tests/io/support.hpp"
#include "tests/support/ros_writer.hpp"
#include "veridyn/io/read.hpp"

namespace veridyn::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kRosBegin_ns;
using testing::message_of;
using testing::MessageWriter;

std::string part(int begin) {
  testing::McapWriter writer;
  writer.schema(1, "std_msgs/msg/Float64", "ros2msg", "float64 data");
  writer.channel(1, 1, "/v");
  for (int i = begin; i < begin + 5; ++i)
    writer.message(1, kRosBegin_ns + i * 100'000'000LL, MessageWriter().number(1.0 * i).bytes());
  writer.finish();
  return writer.bytes();
}

TEST(BagFiles, AreThoseOfTheMetadata) {
  EXPECT_THAT(internal::bag_files("rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"
                                  "  relative_file_paths:\n    - drive_0.mcap\n    - \"drive 1.mcap\"\r\n"
                                  "  duration:\n    - no_file\n"),
              ElementsAre("drive_0.mcap", "drive 1.mcap"));
  EXPECT_THAT(internal::bag_files(""), ElementsAre());
}

TEST(BagFolder, IsOneRecordingOfAllItsFiles) {
  const testing::TemporaryFolder folder;
  (void)folder.write("drive_10.mcap", part(5));
  (void)folder.write("drive_9.mcap", part(0));
  EXPECT_FALSE(is_bag_folder(folder.path()));
  (void)folder.write("metadata.yaml", "rosbag2_bagfile_information:\n  version: 5\n");
  const Log log = read_log(folder.path());
  EXPECT_EQ(log.format, "ROS 2 bag");
  ASSERT_EQ(log.topics.size(), 1U);
  ASSERT_EQ(log.count("v"), 10U);
  EXPECT_EQ(log.find("v")->fields.front().value(9), 9.0);
  EXPECT_EQ(log.find("v")->reordered, 0U) << "drive_10 comes after drive_9";
  EXPECT_NEAR(log.find("v")->time->back(), 0.9, 1e-9);
}

TEST(BagFolder, NotesWhatIsMissing) {
  const testing::TemporaryFolder folder;
  (void)folder.write("a_0.mcap", part(0));
  (void)folder.write("metadata.yaml", "  relative_file_paths:\n  - a_0.mcap\n  - a_1.mcap\n  - a_2.db3.zstd\n");
  (void)folder.write("a_2.db3.zstd", "\x28\xb5\x2f\xfd");
  const Log log = read_log(folder.path());
  EXPECT_EQ(log.count("v"), 5U);
  EXPECT_THAT(log.damage.notes, ::testing::Contains(HasSubstr("a_1.mcap: no such file")));
  EXPECT_THAT(log.damage.notes, ::testing::Contains(HasSubstr("a_2.db3.zstd: is compressed: unpack it with unzstd")));
  (void)folder.write("a_0.mcap", "broken");
  EXPECT_THAT(message_of([&] { (void)read_log(folder.path()); }), HasSubstr("a_0.mcap: is neither an MCAP recording"));
}

TEST(BagFolder, MayHoldDatabases) {
  const testing::TemporaryFolder folder;
  testing::write_bag_database(folder.path() / "b_0.db3", {{1, "/v", "std_msgs/msg/Float64"}},
                              {{1, kRosBegin_ns, MessageWriter().number(4.5).bytes()}});
  (void)folder.write("metadata.yaml", "  relative_file_paths:\n  - bag/b_0.db3\n");
  EXPECT_EQ(read_log(folder.path()).find("v")->fields.front().value(0), 4.5);
}

}  // namespace
}  // namespace veridyn::io
