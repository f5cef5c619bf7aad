#include "veridyn/recording/channel_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tests/support/refusal.hpp"

namespace veridyn::recording {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::array<StandardChannel, 2> kStandard{{{"steer", "rad"}, {"speed", "m/s"}}};

/// Three channels on two time bases.
Recording log_of_three() {
  Recording log;
  const TimeBase time = make_time_base({0.0, 1.0, 2.0});
  log.add(make_channel("left", "m/s", time, {10.0, 11.0, 12.0}));
  log.add(make_channel("right", "m/s", make_time_base({0.0, 2.0}), {20.0, 24.0}));
  log.add(make_channel("gear", "1", time, {1.0, 2.0, 1.0}));
  return log;
}

MappedRecording mapped_by(const std::string& map) {
  const Study study = Study::parse("[data.map]\n" + map, "s.toml");
  MappedRecording mapped;
  mapped = with_channel_map(std::move(mapped), log_of_three(), kStandard, study.root().table("data").table("map"));
  return mapped;
}

TEST(ChannelMap, TakesOneChannelWithZeroScaleAndDelay) {
  const MappedRecording m = mapped_by("speed = { channel = 'left', zero = 8, scale = 2, delay = '0.5 s' }");
  const Channel* speed = m.recording.find("speed");
  ASSERT_NE(speed, nullptr);
  EXPECT_THAT(speed->value, ElementsAre(4.0, 6.0, 8.0));
  EXPECT_THAT(speed->times(), ElementsAre(-0.5, 0.5, 1.5));
  ASSERT_EQ(m.origins.size(), 1u);
  EXPECT_EQ(m.origins[0].source, "left");
}

TEST(ChannelMap, WeighsSeveralChannelsOnTheTimeOfTheFirst) {
  EXPECT_THAT(mapped_by("speed = { channels = ['left', 'right'] }").recording.find("speed")->value,
              ElementsAre(15.0, 16.5, 18.0));
  EXPECT_THAT(mapped_by("speed = { channels = ['left', 'right'], weights = [1, -1] }").recording.find("speed")->value,
              ElementsAre(-10.0, -11.0, -12.0));
}

TEST(ChannelMap, SwitchesBetweenChannels) {
  const MappedRecording m = mapped_by("speed = { switch = 'gear', cases = { 1 = 'left', 2 = 'right' } }");
  EXPECT_THAT(m.recording.find("speed")->value, ElementsAre(10.0, 22.0, 12.0));
}

TEST(ChannelMap, TakesOfTwoMeaningsOfAUnitThatOfTheChannel) {
  Recording log;
  const Unit gauss = parse_unit("G");
  log.add(Channel{"Az", gauss.si(), "G", make_time_base({0.0, 1.0}), {gauss.to_si(1.0), gauss.to_si(2.0)}});
  log.add(Channel{"raw", Unit{}, "1", make_time_base({0.0, 1.0}), {1.0, 2.0}});
  const std::vector<StandardChannel> standard{{"accel_z", "m/s^2"}};
  for (const char* map : {"accel_z = 'Az'", "accel_z = { channel = 'Az' }", "accel_z = { channel = 'raw', unit = 'G' }",
                          "accel_z = 'raw'\nunits = ['knots', 'G']"}) {
    const Study study = Study::parse(std::string("[data.map]\n") + map, "s.toml");
    const MappedRecording m = with_channel_map({}, log, standard, study.root().table("data").table("map"));
    EXPECT_NEAR(m.recording.at("accel_z").value[1], 19.6133, 1e-12) << map;
  }
}

TEST(ChannelMap, RefusesWithTheKey) {
  const auto refusal = [](const char* map) { return why([&] { static_cast<void>(mapped_by(map)); }); };
  EXPECT_THAT(refusal("speeed = 'left'"), HasSubstr("is not a standard channel"));
  EXPECT_THAT(refusal("speed = 'lefft'"), HasSubstr("has no channel 'lefft'"));
  EXPECT_THAT(refusal("steer = 'left'"), HasSubstr("channel 'left' is in [m/s], but steer is in [rad]"));
  EXPECT_THAT(refusal("speed = { channels = ['left', 'right'], weights = [1] }"),
              HasSubstr("1 numbers for 2 channels"));
  EXPECT_THAT(refusal("speed = { switch = 'gear', cases = { first = 'left' } }"), HasSubstr("a case is a number"));
}

}  // namespace
}  // namespace veridyn::recording
