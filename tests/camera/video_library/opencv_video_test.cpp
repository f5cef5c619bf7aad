#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/camera/tracking/video_library.hpp"

/// The functions of the library behind the table, as they are called across its border.
namespace veridyn::camera {
namespace {

namespace fs = std::filesystem;

class OpencvVideo : public ::testing::Test {
 protected:
  const VideoLibrary& library_ = video_library();
  test::TemporaryFolder temporary_;
  const fs::path& folder_ = temporary_.path();
};

// A grey level per frame: what the compression changes of an even picture is a level or two.
TEST_F(OpencvVideo, ReadsTheFramesThatItWrote) {
  const std::string path = (folder_ / "levels.avi").string();
  constexpr int kWidth = 32, kHeight = 16;
  const std::vector<std::uint8_t> levels{40, 90, 200};
  void* writer = library_.open_writer(path.c_str(), kWidth, kHeight, 25.0);
  ASSERT_NE(writer, nullptr);
  for (const std::uint8_t level : levels) {
    const std::vector<std::uint8_t> pixels(std::size_t{kWidth} * kHeight, level);
    EXPECT_TRUE(library_.write(writer, pixels.data()));
  }
  library_.close_writer(writer);

  VideoProperties properties;
  std::string error;
  void* reader = library_.open_reader(path.c_str(), properties, error);
  ASSERT_NE(reader, nullptr) << error;
  EXPECT_EQ(properties.width, kWidth);
  EXPECT_EQ(properties.height, kHeight);
  EXPECT_EQ(properties.rate_Hz, 25.0);
  for (const std::uint8_t level : levels) {
    DecodedFrame frame;
    ASSERT_EQ(library_.read(reader, frame, error), VideoRead::kFrame) << error;
    EXPECT_EQ(frame.width, kWidth);
    EXPECT_EQ(frame.height, kHeight);
    EXPECT_EQ(frame.bits, 8);
    EXPECT_NEAR(frame.pixels[0], level, 2);
    EXPECT_NEAR(frame.pixels[(kHeight - 1) * frame.row_bytes + kWidth - 1], level, 2);
  }
  DecodedFrame none;
  EXPECT_EQ(library_.read(reader, none, error), VideoRead::kEnd);
  library_.close_reader(reader);
}

TEST_F(OpencvVideo, OpensNothingThatIsNoVideo) {
  VideoProperties properties;
  std::string error;
  EXPECT_EQ(library_.open_reader((folder_ / "nothing.avi").c_str(), properties, error), nullptr);
  const fs::path text = folder_ / "text.avi";
  std::ofstream(text) << "no video\n";
  EXPECT_EQ(library_.open_reader(text.c_str(), properties, error), nullptr);
}

TEST_F(OpencvVideo, WritesNoVideoWhereThereIsNoFolder) {
  EXPECT_EQ(library_.open_writer((folder_ / "nowhere" / "video.avi").c_str(), 32, 16, 25.0), nullptr);
}

}  // namespace
}  // namespace veridyn::camera
