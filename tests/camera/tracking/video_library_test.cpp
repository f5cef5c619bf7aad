#include "veridyn/camera/tracking/video_library.hpp"

#include <gtest/gtest.h>

#include <string>

namespace veridyn::camera {
namespace {

TEST(VideoLibrary, IsLoadedOnceWithAllOfItsFunctions) {
  const VideoLibrary& library = video_library();
  EXPECT_EQ(&library, &video_library());
  EXPECT_NE(library.open_reader, nullptr);
  EXPECT_NE(library.read, nullptr);
  EXPECT_NE(library.close_reader, nullptr);
  EXPECT_NE(library.open_writer, nullptr);
  EXPECT_NE(library.write, nullptr);
  EXPECT_NE(library.close_writer, nullptr);
}

}  // namespace
}  // namespace veridyn::camera
