#include "veridyn/vehicle/identification/options/drive_open_loop_options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::vehicle {
namespace {

DriveOpenLoopOptions read(const std::string& keys) {
  const Study study = Study::parse("[validate]\n" + keys, "s.toml");
  return DriveOpenLoopOptions::keys().read(study.root().table("validate"));
}

TEST(DriveOpenLoopOptions, AreTheKeysThatAircraftHave) {
  EXPECT_FALSE(read("").asked());
  const DriveOpenLoopOptions options =
      read("open_loop = \"1 min\"\nopen_loop_start = 3\nopen_loop_offsets = [\"yaw_rate_bias\"]\n");
  EXPECT_EQ(options.times.duration_s, 60.0);
  EXPECT_EQ(options.times.start_s, 3.0);
  ASSERT_TRUE(options.offsets.has_value());
  EXPECT_THAT(*options.offsets, ::testing::ElementsAre(DriveUnknown::kYawRateBias));
  EXPECT_TRUE(read("open_loop = 5\nopen_loop_offsets = []\n").offsets->empty());
  EXPECT_FALSE(read("open_loop = 5\n").offsets.has_value());
}

TEST(DriveOpenLoopOptions, ThatMakeNoSenseAreRefusedByName) {
  for (const auto& [keys, message] :
       {std::pair{"open_loop = -1", "open_loop"},
        std::pair{"open_loop = 2\nopen_loop_start = 2", "must be longer than"},
        std::pair{"open_loop = 9\nopen_loop_offsets = [\"yaw_bias\"]", "'yaw_bias' is no bias"},
        std::pair{"open_loop = 9\nopen_loop_offsets = [\"C_f\"]", "'C_f' is no bias"}}) {
    try {
      (void)read(keys);
      FAIL() << keys;
    } catch (const InputError& error) {
      EXPECT_THAT(std::string(error.what()), ::testing::HasSubstr(message));
    }
  }
}

}  // namespace
}  // namespace veridyn::vehicle
