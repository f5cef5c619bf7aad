#include "veridyn/cueing/platform/platform.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

using ::testing::HasSubstr;

Platform read_rig(const std::string& text) {
  const Study study = Study::parse("[platform]\n" + text, "rig.toml");
  const Platform p = Platform::read(study.root().table("platform"));
  study.root().finish();
  return p;
}

std::string rig_refusal(const std::string& text) {
  try {
    static_cast<void>(read_rig(text));
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Platform, ReadsABuiltInOneWithOtherLimits) {
  const Platform p = read_rig("subject = \"three_axis\"\nroll = [\"-10 deg\", \"12 deg\"]\nheave_rate = 0.2\n");
  EXPECT_NEAR(p.limits[PlatformAxis::kRoll].highest, 12.0 * kDegree, 1e-15);
  EXPECT_EQ(p.limits[PlatformAxis::kHeave].rate, 0.2);
  EXPECT_NEAR(p.limits[PlatformAxis::kPitch].lowest, -15.0 * kDegree, 1e-15);
  EXPECT_FALSE(p.limits[PlatformAxis::kYaw].moves());
}

TEST(Platform, ReadsAnOwnOne) {
  const Platform p = read_rig(
      "roll = [\"-10 deg\", \"10 deg\"]\nroll_rate = \"20 deg/s\"\nroll_acceleration = 3\n"
      "roll_commanded = [\"-10 deg\", \"10 deg\"]\nroll_reached = [\"-9 deg\", \"8 deg\"]\nomega = 20\ndelay = \"30 "
      "ms\"\n");
  EXPECT_EQ(p.limits[PlatformAxis::kRoll].jerk, 60.0);
  EXPECT_NEAR(p.reach[PlatformAxis::kRoll].at(0.0).reached, -0.5 * kDegree, 1e-12);
  EXPECT_EQ(p.reach[PlatformAxis::kRoll].at(1.0).slope, 0.0);
  EXPECT_EQ(p.actuators.delay, 0.03);
}

TEST(Platform, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(rig_refusal("subject = \"hexapot\""), HasSubstr("hexapod"));
  EXPECT_THAT(rig_refusal("roll = [\"2 deg\", \"10 deg\"]\nroll_rate = 1\nroll_acceleration = 3\n"),
              HasSubstr("rig.toml:2: platform.roll"));
  EXPECT_THAT(rig_refusal("subject = \"three_axis\"\nroll_rate = 0\n"), HasSubstr("rig.toml:3: platform.roll_rate"));
  EXPECT_THAT(rig_refusal("roll = [-0.1, 0.1]\n"), HasSubstr("roll_rate"));
  EXPECT_THAT(rig_refusal("omega = 20\n"), HasSubstr("no axis that moves"));
  EXPECT_THAT(rig_refusal("subject = \"hexapod\"\nleg_stroke = [-0.3, 0.3]\n"), HasSubstr("neutral length"));
  EXPECT_THAT(rig_refusal("subject = \"three_axis\"\ndelay = 1\n"), HasSubstr("platform.delay"));
}

TEST(BuiltInPlatforms, AreValid) {
  for (const Platform& p : built_in_platforms()) EXPECT_NO_THROW(p.validate()) << p.name;
}

}  // namespace
}  // namespace veridyn::cueing
