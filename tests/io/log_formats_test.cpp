#include "veridyn/io/log_formats.hpp"

#include <set>

#include "tests/io/support.hpp"
#include "tests/support/small_logs.hpp"

namespace veridyn::io {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(LogFormats, HaveKeysNamesAndSuffixesOfTheirOwn) {
  std::set<std::string_view> keys, names, suffixes;
  std::size_t count = 0;
  for (const LogFormat& format : log_formats()) {
    EXPECT_TRUE(keys.insert(format.key).second) << format.key;
    EXPECT_TRUE(names.insert(format.name).second) << format.name;
    for (const std::string_view suffix : format.suffixes) {
      EXPECT_TRUE(suffixes.insert(suffix).second) << suffix;
      EXPECT_EQ(log_format_by_suffix("LOG" + std::string(suffix)), &format);
      ++count;
    }
  }
  EXPECT_EQ(suffixes.size(), count);
  EXPECT_EQ(log_format_by_suffix("FLIGHT.ULG")->name, "PX4 ULog");
  EXPECT_EQ(log_format_by_suffix("flight.png"), nullptr);
}

// Each has a log to start the tests of all formats and fuzzing from; it is taken for nothing else, and read.
TEST(LogFormats, AreRecognisedByTheirSmallLogs) {
  std::set<std::string_view> tried;
  for (const testing::SmallLog& log : testing::small_logs()) {
    SCOPED_TRACE(std::string(log.key) + ", " + std::string(log.name));
    const LogFormat* format = log_format_of(log.bytes);
    ASSERT_NE(format, nullptr);
    EXPECT_EQ(format->key, log.key);
    tried.insert(log.key);
  }
  EXPECT_EQ(tried.size(), log_formats().size());
}

TEST(LogFormats, ReadFromBytesWhatTheyReadFromFiles) {
  const testing::TemporaryFolder folder;
  std::size_t compared = 0;
  for (const testing::SmallLog& log : testing::small_logs()) {
    const LogFormat* format = log_format_of(log.bytes);
    if (format == nullptr || format->read_file == nullptr) continue;
    SCOPED_TRACE(log.key);
    const Log bytes = format->read(log.bytes, "x", {}), file = format->read_file(folder.write("log", log.bytes), {});
    ASSERT_EQ(bytes.topics.size(), file.topics.size());
    for (std::size_t i = 0; i < bytes.topics.size(); ++i) {
      EXPECT_EQ(bytes.topics[i].name, file.topics[i].name);
      EXPECT_EQ(bytes.topics[i].size(), file.topics[i].size());
    }
    ++compared;
  }
  EXPECT_GE(compared, 2U);
}

// What begins like one format may hold the mark of another further on.
TEST(LogFormats, BelieveTheBeginningFirst) {
  const std::string text = "\nFMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n";
  for (const testing::SmallLog& log : testing::small_logs()) {
    const LogFormat* format = log_format_of(log.bytes);
    if (format == nullptr || format->recognition != Recognition::kBeginning) continue;
    EXPECT_EQ(log_format_of(log.bytes + text), format) << log.key;
  }
}

TEST(LogFormats, AreListedInASentence) {
  const std::string& list = list_of_log_formats();
  EXPECT_THAT(list, StartsWith("ArduPilot DataFlash (.bin, .log), PX4 ULog (.ulg), "));
  EXPECT_THAT(list, EndsWith(" and CSV"));
  for (const LogFormat& format : log_formats()) EXPECT_THAT(list, HasSubstr(std::string(format.listed)));
}

}  // namespace
}  // namespace veridyn::io
