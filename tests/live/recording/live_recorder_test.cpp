#include "veridyn/live/recording/live_recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string_view>

#include "tests/live/recording/some_records.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;
using testing::some_head;
using testing::some_records;

class LiveRecorderTest : public ::testing::Test {
 protected:
  veridyn::test::TemporaryFolder temporary_;
  std::filesystem::path path_ = temporary_.path() / "recorded.vlr";
};

TEST_F(LiveRecorderTest, WritesEveryRecordInOrder) {
  constexpr int kCount = 20000;
  {
    LiveRecorder recorder(path_, some_head());
    LiveRecord r = some_records()[3];
    for (int k = 0; k < kCount; ++k) {
      r.time = k;
      recorder.record(r);
    }
    EXPECT_EQ(recorder.lost(), 0U);
    EXPECT_EQ(recorder.trouble(), "");
  }
  int k = 0;
  const LiveFile file = read_live_file(path_);
  for (const std::string_view block : file.blocks)
    EXPECT_TRUE(for_each_record(block, [&](const LiveRecord& r) { EXPECT_EQ(r.time, k++); }));
  EXPECT_EQ(k, kCount);
  EXPECT_EQ(file.cut_bytes, 0U);
  EXPECT_GT(file.blocks.size(), 5U);
}

TEST_F(LiveRecorderTest, CountsWhatTheDiskDoesNotTakeAndSaysSo) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  // A disk that is full from the first byte on is refused at once.
  EXPECT_THAT(why([] { LiveRecorder("/dev/full", some_head()); }), HasSubstr("No space left on device"));
  EXPECT_THAT(why([] { LiveRecorder("/nowhere/run.vlr", some_head()); }), HasSubstr("/nowhere/run.vlr"));
}

}  // namespace
}  // namespace veridyn::live
