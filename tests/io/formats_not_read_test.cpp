#include "veridyn/io/formats_not_read.hpp"

#include "tests/io/support.hpp"
#include "tests/support/small_logs.hpp"
#include "veridyn/io/read.hpp"

namespace veridyn::io {
namespace {

using ::testing::HasSubstr;
using testing::message_of;

TEST(FormatsNotRead, AreNamedWithWhatToDo) {
  const testing::TemporaryFolder folder;
  const std::pair<std::string, const char*> kFiles[] = {
      {"MDF     4.10    ", "an ASAM MDF measurement"},
      {"VERSION \"\"\n\nBO_ 100 X: 8 A\n", "a DBC, which describes"},
      {"(1436509052.249713) vcan0 044#2A366C2BBA\n", "a CAN log of candump"},
      {"date Fri May 3 12:00:00 2024\nbase hex  timestamps absolute\n", "a Vector ASC log"},
      {"LOGG\x90", "a Vector BLF log"},
      {"#ROSBAG V2.0\n", "a bag of ROS 1"},
      {"\x28\xb5\x2f\xfd\x04", "compressed by Zstandard"},
      {std::string("PK\x03\x04\x14\0\x06\0[Content_Types].xml", 27), "an Excel workbook"}};
  for (const auto& [content, name] : kFiles) {
    const auto path = folder.write("drive.dat", content);
    EXPECT_THAT(message_of([&] { (void)read_log(path); }), HasSubstr("drive.dat: is " + std::string(name))) << name;
  }
}

TEST(FormatsNotRead, AreNoneOfThoseThatAreRead) {
  for (const testing::SmallLog& log : testing::small_logs()) EXPECT_FALSE(format_not_read(log.bytes)) << log.key;
  EXPECT_FALSE(format_not_read("date,time,base\n1,2,3\n"));
}

}  // namespace
}  // namespace veridyn::io
