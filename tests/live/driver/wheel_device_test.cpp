#include "veridyn/live/driver/wheel_device.hpp"

#include <gtest/gtest.h>
#include <linux/input.h>

#include <string>
#include <vector>

#include "tests/live/driver/wheel_file.hpp"
#include "tests/live/serial/without_rights.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::live {
namespace {

using testing::WheelFile;

TEST(WheelDevice, IsRefusedInOneLine) {
  const auto refusal = [](const std::string& path) { return why([&] { WheelDevice device(path); }); };
  const WheelFile file("text");
  if (!has_wheel_devices()) {
    EXPECT_EQ(refusal(file.path()),
              file.path() + ": this build reads no wheels: it was made without libevdev (VERIDYN_WHEEL)");
    return;
  }
  EXPECT_EQ(refusal("/dev/input/event_none"), "/dev/input/event_none: there is no such device; is it plugged in?");
  EXPECT_EQ(refusal(file.path()), file.path() + ": not an input device");
  EXPECT_EQ(refusal("/dev/null"), "/dev/null: not an input device");
  {
    const testing::WithoutRights closed;
    EXPECT_EQ(refusal(closed.path()), closed.path() + ": no right to open it; members of the group 'input' have it");
  }
  EXPECT_EQ(refusal(::testing::TempDir()), ::testing::TempDir() + ": not an input device");
}

TEST(WheelDevice, IsAWheelWithSteeringAndAPedal) {
  const auto refusal = [](std::vector<WheelAxis> axes) { return why([&] { check_wheel("event5", "Device", axes); }); };
  const WheelAxis x{.code = ABS_X, .lowest = 0, .highest = 65535},
      wheel{.code = ABS_WHEEL, .lowest = -512, .highest = 511}, z{.code = ABS_Z, .lowest = 0, .highest = 255},
      hat{.code = ABS_HAT0X, .lowest = -1, .highest = 1};
  EXPECT_EQ(refusal({x, z}), "nothing was refused");
  EXPECT_EQ(refusal({wheel, z}), "nothing was refused");
  EXPECT_EQ(refusal({z, hat}), "event5: 'Device' is not a wheel: it has neither ABS_X nor ABS_WHEEL");
  EXPECT_EQ(refusal({}), "event5: 'Device' is not a wheel: it has neither ABS_X nor ABS_WHEEL");
  EXPECT_EQ(refusal({x}), "event5: 'Device' is not a wheel with pedals: it has one axis only");
  EXPECT_EQ(refusal({x, {.code = ABS_Z, .lowest = 5, .highest = 5}}),
            "event5: 'Device': axis ABS_Z has no range: 5 to 5");
}

}  // namespace
}  // namespace veridyn::live
