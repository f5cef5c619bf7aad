#include "veridyn/cueing/washout/driver_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::cueing {
namespace {

std::vector<double> values_of(WashoutDesign& design, const std::string& name) {
  for (const Knob& knob : design.knobs()) {
    if (knob.name == name) return {knob.values.begin(), knob.values.end()};
  }
  return {};
}

DriverSettings settings_of(const std::string& text) {
  const Study study = Study::parse("[cue]\n" + text, "rig.toml");
  return DriverSettings::keys().read(study.root().table("cue"));
}

TEST(DriverSettings, PresetsTurnTheKnobsThatMeanTheSame) {
  const auto design = washout_algorithm("three_axis").design();
  settings_of("preset = \"medium\"\n").apply(*design);
  EXPECT_THAT(values_of(*design, "force_gain"), ::testing::Each(0.68));
  EXPECT_THAT(values_of(*design, "sustained"), ::testing::ElementsAre(0.45));
  EXPECT_THAT(values_of(*design, "instant"), ::testing::ElementsAre(0.15));
  EXPECT_THAT(values_of(*design, "tilt"), ::testing::ElementsAre(4.4));
  const std::vector<double> rates = values_of(*design, "rate_gain");
  EXPECT_DOUBLE_EQ(rates[0], 0.68 * 0.3);  // roll, pitch: the chassis'; yaw is its own
  EXPECT_DOUBLE_EQ(rates[1], 0.68 * 0.3);
  EXPECT_DOUBLE_EQ(rates[2], 0.68);
  // An algorithm without such knobs keeps its own numbers.
  const auto tilt = washout_algorithm("tilt").design();
  settings_of("preset = \"high\"\nsustained = 2\n").apply(*tilt);
  EXPECT_THAT(values_of(*tilt, "force_gain"), ::testing::Each(1.0));
}

TEST(DriverSettings, ASettingComesBeforeThePreset) {
  const DriverSettings s = settings_of("preset = \"low\"\noverall = 50\nchassis = 20\n");
  EXPECT_EQ(s.overall, 50.0);
  EXPECT_EQ(s.chassis, 20.0);
  EXPECT_EQ(s.sustained, 0.45);
  const auto design = washout_algorithm("classical").design();
  settings_of("").apply(*design);
  EXPECT_EQ(values_of(*design, "force_gain"), (std::vector<double>{0.6, 0.6, 0.5}));
}

TEST(DriverSettings, OutOfRangeIsRefusedWithItsPlace) {
  try {
    static_cast<void>(settings_of("instant = 1.5\n"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("rig.toml:2: cue.instant: = 1.5 must be from 0 to 1"));
  }
}

}  // namespace
}  // namespace veridyn::cueing
