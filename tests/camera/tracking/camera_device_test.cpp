#include "veridyn/camera/tracking/camera_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::camera {
namespace {

using ::testing::HasSubstr;

std::string refused_device(const std::filesystem::path& device) {
  return why([&] { CameraDevice camera(device, {}); });
}

CameraDeviceOptions read(const std::string& text) {
  return CameraDeviceOptions::keys().read(Study::parse(text, "set.toml").root());
}

// Pictures of a camera come in tests/apps/camera_program_test.cpp, from a driver that is loaded before the program.
TEST(CameraDevice, IsRefusedInOneLine) {
  EXPECT_EQ(refused_device("/dev/video_none"), "/dev/video_none: there is no such device; is it plugged in?");
  EXPECT_EQ(refused_device("/dev/null"), "/dev/null: is no camera");
  const test::TemporaryFolder folder;
  write_file(folder.path() / "text", "text");
  EXPECT_THAT(refused_device(folder.path() / "text"), HasSubstr("text: is no camera"));
  EXPECT_EQ(internal::camera_refusal(EACCES), "no right to open it; members of the group 'video' have it");
  EXPECT_EQ(internal::camera_refusal(EBUSY), "in use by another program");
  EXPECT_EQ(internal::camera_refusal(EIO), "cannot be opened: Input/output error");
}

TEST(CameraDevice, OptionsAreWhatIsAskedOfIt) {
  const CameraDeviceOptions o = read("width = 1280\nheight = 720\nrate = 60\nformat = \"MJPG\"\n");
  EXPECT_EQ(o.width, 1280);
  EXPECT_EQ(o.height, 720);
  EXPECT_EQ(o.rate_Hz, 60.0);
  EXPECT_EQ(o.format, "MJPG");
  EXPECT_EQ(read("").width, 0);
  EXPECT_THAT(why([] { (void)read("width = 1280\n"); }), HasSubstr("width: needs the other one"));
  EXPECT_THAT(why([] { (void)read("height = -1\nwidth = 4\n"); }), HasSubstr("height: = -1 must be from 0"));
  EXPECT_THAT(why([] { (void)read("rate = -5\n"); }), HasSubstr("rate: = -5 Hz must be from 0 to 1000 Hz"));
  EXPECT_THAT(why([] { (void)read("format = \"JPEG2\"\n"); }), HasSubstr("must be four letters"));
}

}  // namespace
}  // namespace veridyn::camera
