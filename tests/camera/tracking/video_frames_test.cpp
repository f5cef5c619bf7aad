#include "veridyn/camera/tracking/video_frames.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::camera {
namespace {

class VideoFramesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (int k = 0; k < 20; ++k) {
      GreyImage image{.width = 64, .height = 48, .pixels = {}};
      for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) image.pixels.push_back(static_cast<std::uint8_t>(20 + 2 * x + 3 * k));
      images_.push_back(image);
    }
  }

  std::string read_all(const std::filesystem::path& file) {
    return why([&] {
      VideoFrames frames(file);
      while (frames.next()) {
      }
    });
  }

  test::TemporaryFolder temporary_;
  const std::filesystem::path& folder_ = temporary_.path();
  std::vector<GreyImage> images_;
};

TEST_F(VideoFramesTest, ComeBackAsTheyWereWritten) {
  const auto file = folder_ / "video.avi";
  write_video(file, images_, 30.0);
  VideoFrames frames(file);
  EXPECT_EQ(frames.width(), 64);
  EXPECT_EQ(frames.height(), 48);
  EXPECT_NEAR(frames.rate_Hz(), 30.0, 1e-9);
  std::size_t k = 0;
  while (const auto frame = frames.next()) {
    ASSERT_LT(k, images_.size());
    EXPECT_NEAR(frame->time, static_cast<double>(k) / 30.0, 1e-9);
    double worst = 0.0;
    for (std::size_t i = 0; i < frame->image.pixels.size(); ++i)
      worst = std::max(worst, std::abs(static_cast<double>(frame->image.pixels[i]) - images_[k].pixels[i]));
    EXPECT_LE(worst, 4.0) << "beyond the losses of the compression";
    ++k;
  }
  EXPECT_EQ(k, images_.size());
}

TEST_F(VideoFramesTest, OneLineForAFileThatIsCutOrNone) {
  const auto file = folder_ / "video.avi";
  write_video(file, images_, 30.0);
  const std::string whole = read_file(file);
  const auto cut = folder_ / "cut.avi";
  write_file(cut, whole.substr(0, whole.size() / 2));
  EXPECT_THAT(read_all(cut), ::testing::AnyOf(::testing::HasSubstr("of the 20 frames that it announces"),
                                              ::testing::HasSubstr("is no video that can be read")));
  write_file(folder_ / "text.avi", "no video");
  EXPECT_EQ(read_all(folder_ / "text.avi"), (folder_ / "text.avi").string() + ": is no video that can be read");
  EXPECT_EQ(read_all(folder_ / "missing.avi"), (folder_ / "missing.avi").string() + ": is not a file");
  EXPECT_EQ(read_all(file), "nothing was refused");
}

}  // namespace
}  // namespace veridyn::camera
