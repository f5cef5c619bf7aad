#include "veridyn/live/recording/growing_live_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <string>

#include "tests/live/recording/some_records.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;

class GrowingLiveFileTest : public ::testing::Test {
 protected:
  void append(const std::string& bytes) const { std::ofstream(path_, std::ios::binary | std::ios::app) << bytes; }
  /// A block with one record, a turn of the knob of this number.
  static std::string block(std::uint16_t number) {
    LiveRecord r = testing::some_records()[2];
    r.knob = number;
    std::array<char, kLargestRecord> bytes{};
    const std::size_t size = encode(r, bytes);
    return framed({bytes.data(), size});
  }
  static void read_all(GrowingLiveFile& file, std::vector<int>& knobs) {
    while (file.read([&](const LiveRecord& r) { knobs.push_back(r.knob); })) continue;
  }

  veridyn::test::TemporaryFolder temporary_;
  std::filesystem::path path_ = temporary_.path() / "growing.vlr";
};

TEST_F(GrowingLiveFileTest, HandsEachRecordOverOnceWhereverTheFileIsCutOffMeanwhile) {
  std::string all = framed(encode(testing::some_head()));
  std::vector<int> expected;
  for (std::uint16_t k = 0; k < 5; ++k) {
    all += block(k);
    expected.push_back(k);
  }
  append(all.substr(0, 1));
  GrowingLiveFile file(path_);
  std::vector<int> knobs;
  for (std::size_t k = 1; k < all.size(); ++k) {
    read_all(file, knobs);
    EXPECT_EQ(file.head().has_value(), k >= all.find("BLK1", 1));
    append(all.substr(k, 1));
  }
  read_all(file, knobs);
  EXPECT_EQ(knobs, expected);
  EXPECT_EQ(file.damaged(), 0U);
  EXPECT_EQ(file.head()->session, 7U);
  EXPECT_EQ(file.share(), 1.0);
  read_all(file, knobs);
  EXPECT_EQ(knobs, expected);
}

TEST_F(GrowingLiveFileTest, PassesOverADamagedBlockAndCountsIt) {
  std::string damaged = block(1);
  damaged.back() ^= 1;
  append(framed(encode(testing::some_head())) + block(0) + damaged);
  GrowingLiveFile file(path_);
  std::vector<int> knobs;
  read_all(file, knobs);
  append(block(2));
  read_all(file, knobs);
  EXPECT_EQ(knobs, (std::vector<int>{0, 2}));
  EXPECT_EQ(file.damaged(), 1U);
}

TEST_F(GrowingLiveFileTest, RefusesWhatIsNoRecording) {
  EXPECT_THAT(why([&] { GrowingLiveFile(path_ / "missing"); }), HasSubstr("cannot be read"));
  append(std::string(100, 'x'));
  GrowingLiveFile text(path_);
  EXPECT_THAT(why([&] { static_cast<void>(text.read([](const LiveRecord&) {})); }), HasSubstr("it has no head"));
  std::filesystem::remove(path_);
  append(framed(encode(testing::some_head())) + block(0));
  GrowingLiveFile file(path_);
  std::vector<int> knobs;
  read_all(file, knobs);
  std::filesystem::resize_file(path_, 10);
  EXPECT_THAT(why([&] { read_all(file, knobs); }), HasSubstr("became shorter"));
}

}  // namespace
}  // namespace veridyn::live
