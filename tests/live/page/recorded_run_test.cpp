// The reader of JSON is only there where the page is.
#ifdef VERIDYN_HAS_PAGE
#include "veridyn/live/page/recorded_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "tests/live/rig/recorded_run.hpp"

namespace veridyn::live {
namespace {

using test::LiveLoopTest;
using ::testing::HasSubstr;

/// Of a test's own: its recording grows when the test says so.
class RecordedRunTest : public LiveLoopTest {
 protected:
  void SetUp() override {
    LiveLoopTest::SetUp();
    grown_ = path_;
    grown_ += ".grown";
    test::record_run(path_, head_of(test::kRecordedStudy), 10 * kSecond);
    bytes_ = in_blocks_of_a_quarter_second(read_live_file(path_));
  }
  /// As a recorder writes it that has the run's time.
  static std::string in_blocks_of_a_quarter_second(const LiveFile& file) {
    std::string all = framed(encode(file.head)), content;
    Nanoseconds begun = 0;
    std::array<char, kLargestRecord> bytes{};
    for (const std::string_view block : file.blocks) {
      for_each_record(block, [&](const LiveRecord& r) {
        if (r.time - begun > kSecond / 4) {
          all += framed(std::exchange(content, {}));
          begun = r.time;
        }
        content.append(bytes.data(), encode(r, bytes));
      });
    }
    return all + framed(content);
  }
  void TearDown() override {
    std::filesystem::remove(grown_);
    LiveLoopTest::TearDown();
  }
  void grow_to(double share) const {
    std::ofstream(grown_, std::ios::binary | std::ios::trunc)
        << bytes_.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes_.size())));
  }
  static void read_all(RecordedRun& run) {
    for (int k = 0; k < 3; ++k) run.advance(std::chrono::seconds(10));
  }

  std::filesystem::path grown_;
  std::string bytes_;
};

TEST_F(RecordedRunTest, IsShownFromItsBeginningToItsEndAsItsOwnPageWould) {
  RecordedRun run(path_, 20.0);
  read_all(run);
  const ShownRun shown = run.shown();
  EXPECT_EQ(shown.name, path_.string());
  EXPECT_EQ(shown.trouble, "");
  EXPECT_NEAR(shown.length, 10.0, 0.02);
  EXPECT_EQ(run.state(), RigState::kRunning);
  const auto frames = nlohmann::json::parse(run.frames(4.0, 6.0));
  ASSERT_NEAR(static_cast<double>(frames.size()), 40.0, 2.0);
  EXPECT_NEAR(frames[0]["time"].get<double>(), 4.0, 0.05);
  double last = 0.0;
  for (const auto& f : frames) {
    EXPECT_GT(f["time"].get<double>(), last);
    last = f["time"].get<double>();
    EXPECT_EQ(f["state"], "running");
  }
  EXPECT_EQ(nlohmann::json::parse(run.frames(0.0, 0.0))[0]["state"], "parked");
  EXPECT_EQ(nlohmann::json::parse(run.frames(100.0, 200.0)).size(), 1U);  // the last one still holds
}

TEST_F(RecordedRunTest, GoesOnWhereItsRecordingGrows) {
  grow_to(0.4);
  RecordedRun run(grown_, 20.0);
  read_all(run);
  const double before = run.shown().length;
  EXPECT_GT(before, 3.0);
  EXPECT_LT(before, 5.0);
  EXPECT_TRUE(run.grows());  // it was just written
  grow_to(1.0);
  read_all(run);
  const ShownRun shown = run.shown();
  EXPECT_NEAR(shown.length, 10.0, 0.02);
  EXPECT_TRUE(shown.grows);
  EXPECT_EQ(run.frames(9.0, 10.0), [&] {
    RecordedRun whole(path_, 20.0);
    read_all(whole);
    return whole.frames(9.0, 10.0);
  }());
}

TEST_F(RecordedRunTest, SaysWhyItCannotBeShown) {
  grow_to(0.5);
  RecordedRun run(grown_, 20.0);
  read_all(run);
  grow_to(0.1);
  read_all(run);
  EXPECT_THAT(run.shown().trouble, HasSubstr("became shorter"));
  EXPECT_FALSE(run.shown().grows);
  EXPECT_GT(run.shown().length, 3.0);  // what is known is still shown
}

}  // namespace
}  // namespace veridyn::live
#endif
