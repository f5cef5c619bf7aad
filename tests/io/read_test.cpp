#include "veridyn/io/read.hpp"

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/io/dataflash/dataflash.hpp"
#include "veridyn/io/log_formats.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::message_of;

TEST(ReadLog, KnowsAFileByItsContentWhateverItsName) {
  const testing::TemporaryFolder folder;
  const std::pair<std::string, const char*> kFiles[] = {{testing::small_dataflash(), "ArduPilot DataFlash"},
                                                        {testing::small_dataflash_text(), "ArduPilot DataFlash text"},
                                                        {testing::small_ulog(), "PX4 ULog"},
                                                        {testing::small_mat(), "MATLAB"},
                                                        {testing::small_csv(), "CSV"}};
  for (const auto& [content, format] : kFiles) {
    EXPECT_EQ(read_log(folder.write("noextension", content)).format, format);
    EXPECT_EQ(read_log(folder.write("wrong.ulg", content)).format, format);
    EXPECT_EQ(read_log(folder.write("wrong.csv", content)).format, format);
  }
}

TEST(ReadLog, SaysWhenANamePromisesAnotherFormat) {
  const testing::TemporaryFolder folder;
  const Recording recording = read_recording(folder.write("flight.ulg", testing::small_dataflash()));
  EXPECT_THAT(recording.warnings,
              Contains("the name promises PX4 ULog, the content is ArduPilot DataFlash and was read as such"));
}

TEST(ReadLog, RefusesWhatItCannotReadInOneSentence) {
  const testing::TemporaryFolder folder;
  const std::string place = folder.path().string();
  EXPECT_EQ(message_of([&] { (void)read_log(folder.path() / "missing.bin"); }), place + "/missing.bin: no such file");
  EXPECT_THAT(message_of([&] { (void)read_log(folder.path()); }),
              HasSubstr(place + ": is a directory without NumPy arrays that have stamps"));
  EXPECT_EQ(message_of([&] { (void)read_log(folder.write("empty.bin", "")); }),
            place + "/empty.bin: the file is empty");
  EXPECT_EQ(message_of([&] { (void)read_log(folder.write("zero.bin", std::string(5000, '\0'))); }),
            place +
                "/zero.bin: not a known log (its name promises ArduPilot DataFlash, its content is not); known are " +
                list_of_log_formats());
  EXPECT_THAT(
      message_of([&] { (void)read_log(folder.write("picture.png", std::string("\x89PNG\r\n\x1a\n\0\0", 10))); }),
      HasSubstr("not a known log; known are"));
}

TEST(ReadRecording, KeepsOnlyTheTopicsThatAreAskedFor) {
  const testing::TemporaryFolder folder;
  ReadOptions options;
  options.recording.keep_topic = [](std::string_view topic) { return topic == "ATT"; };
  const Recording recording = read_recording(folder.write("flight.bin", testing::small_dataflash()), options);
  EXPECT_THAT(recording.names(), ElementsAre("ATT.Roll", "ATT.Pitch", "ATT.Yaw"));
}

// A recording of ten million rows would take minutes with a quadratic step anywhere.
TEST(ReadLog, ReadsALargeLogInTimeThatGrowsWithItsSize) {
  const Log log = read_dataflash(testing::synthetic_dataflash(20.0), "x.bin");
  EXPECT_EQ(log.damage.bytes_lost, 0U);
  EXPECT_GT(log.count("IMU"), 30000U);
  EXPECT_EQ(log.count("XKF1"), log.count("ATT") * 2);
}

}  // namespace
}  // namespace veridyn::io
