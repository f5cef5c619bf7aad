#include "veridyn/cueing/platform/platform_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/cueing/platform/platform_simulator.hpp"

namespace veridyn::cueing {
namespace {

using ::testing::HasSubstr;

Platform read_back(const Platform& platform) {
  const Study study = Study::parse(platform_file(platform, "of a test"), "platform.toml");
  Platform back = Platform::read(study.root().table("platform"));
  study.root().finish();
  return back;
}

TEST(PlatformFile, ReadsBackToTheSameNumbers) {
  for (Platform p : built_in_platforms()) {
    p.axis_actuators[PlatformAxis::kPitch] = ActuatorOptions{.omega = 1.0 / 0.03, .zeta = 0.7, .delay = 0.02};
    if (p.actuators.omega == 0.0) p.axis_actuators[PlatformAxis::kPitch]->delay = 0.0;
    const Platform back = read_back(p);
    EXPECT_EQ(platform_keys(back), platform_keys(p));
    EXPECT_EQ(back.name, p.name);
    EXPECT_EQ(back.response(PlatformAxis::kPitch).omega, 1.0 / 0.03);
    EXPECT_EQ(back.response(PlatformAxis::kRoll).omega, p.actuators.omega);
    EXPECT_EQ(back.legs.has_value(), p.legs.has_value());
  }
}

TEST(PlatformFile, IsNamedByAStudyWhoseOtherKeysReplaceItsNumbers) {
  const test::TemporaryFolder folder;
  Platform p = built_in_platform("three_axis");
  p.axis_actuators[PlatformAxis::kRoll] = ActuatorOptions{.omega = 22.0, .zeta = 0.9, .delay = 0.03};
  std::ofstream(folder.path() / "platform.toml") << platform_file(p, "measured");
  const auto read = [&](const std::string& text) {
    const Study study = Study::parse("[platform]\n" + text, "study.toml", folder.path());
    const Platform platform = Platform::read(study.root().table("platform"));
    study.root().finish();
    return platform;
  };
  const Platform back = read("file = \"platform.toml\"\nheave_rate = 0.1\nroll_delay = 0.04\n");
  EXPECT_EQ(back.limits[PlatformAxis::kHeave].rate, 0.1);
  EXPECT_EQ(back.response(PlatformAxis::kRoll).omega, 22.0);
  EXPECT_EQ(back.response(PlatformAxis::kRoll).delay, 0.04);
  EXPECT_EQ(back.response(PlatformAxis::kPitch).omega, 30.0);
  EXPECT_THAT(why([&] { static_cast<void>(read("file = \"platform.toml\"\nsubject = \"hexapod\"\n")); }),
              HasSubstr("as well as `file`"));
  std::ofstream(folder.path() / "none.toml") << "[platform]\nomega = 20\n";
  EXPECT_THAT(why([&] { static_cast<void>(read("file = \"none.toml\"\n")); }), HasSubstr("no axis that moves"));
  std::ofstream(folder.path() / "again.toml") << "[platform]\nfile = \"again.toml\"\n";
  EXPECT_THAT(why([&] { static_cast<void>(read("file = \"again.toml\"\n")); }), HasSubstr("further file"));
  EXPECT_THAT(why([&] { static_cast<void>(read("subject = \"three_axis\"\npitch_omega = -1\n")); }),
              HasSubstr("platform.pitch_omega"));
}

// Each axis follows as it was measured: at rest nothing differs, and on the way one is later than the other.
TEST(PlatformFile, EachAxisFollowsAsItWasMeasured) {
  for (const char* name : {"three_axis", "hexapod"}) {
    Platform p = built_in_platform(name);
    p.axis_actuators[PlatformAxis::kRoll] = ActuatorOptions{.omega = 10.0, .zeta = 1.0, .delay = 0.0};
    p.axis_actuators[PlatformAxis::kPitch] = ActuatorOptions{.omega = 10.0, .zeta = 1.0, .delay = 0.1};
    PlatformSimulator simulator(p);
    PlatformState to;
    set_axis(to, PlatformAxis::kRoll, {.position = 0.05});
    set_axis(to, PlatformAxis::kPitch, {.position = 0.05});
    const auto after = [&](int steps) {
      for (int k = 0; k < steps; ++k) simulator.step(to, 1e-3);
      return std::pair(axis(simulator.state(), PlatformAxis::kRoll).position,
                       axis(simulator.state(), PlatformAxis::kPitch).position);
    };
    // 1 - (1 + w t) exp(-w t) of a step, w t = 1 and 2.
    constexpr double kTolerance = 3e-4;  // the first step is one of 1 ms; legs have limits of their own
    const auto early = after(100);
    EXPECT_NEAR(early.first, 0.05 * 0.2642, kTolerance) << name;
    EXPECT_NEAR(early.second, 0.0, kTolerance) << name;
    const auto later = after(100);
    EXPECT_NEAR(later.first, 0.05 * 0.5940, kTolerance) << name;
    EXPECT_NEAR(later.second, 0.05 * 0.2642, kTolerance) << name;
    const auto end = after(3000);
    EXPECT_NEAR(end.first, 0.05, 1e-6);
    EXPECT_NEAR(end.second, 0.05, 1e-6);
  }
}

}  // namespace
}  // namespace veridyn::cueing
