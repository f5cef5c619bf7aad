#include "veridyn/recording/channel_recognition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace veridyn::recording {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::array<StandardChannel, 6> kRecognisable{{{"accel_x", "m/s^2"},
                                                    {"accel_z", "m/s^2"},
                                                    {"gyro_x", "rad/s"},
                                                    {"yaw", "rad"},
                                                    {"airspeed", "m/s"},
                                                    {"roll", "rad"}}};
constexpr std::array<ChannelAlias, 6> kOtherNames{{{"ax", "accel_x"},
                                                   {"az", "accel_z"},
                                                   {"p", "gyro_x"},
                                                   {"psi", "yaw"},
                                                   {"V", "airspeed", "taken as true airspeed"},
                                                   {"phi", "roll"}}};

Recording log_of(const std::vector<std::pair<std::string, std::vector<double>>>& channels) {
  Recording log;
  const TimeBase time = make_time_base({0.0, 1.0, 2.0});
  for (const auto& [name, value] : channels) log.add(make_channel(name, "1", time, value));
  return log;
}

Recognition recognised(const Recording& log) { return recognise_channels(log, {}, kRecognisable, kOtherNames); }

std::string unit_of(const Recognition& recognition, std::string_view channel) {
  for (const RecognisedChannel& one : recognition.found)
    if (one.channel == channel) return one.unit;
  return "not found";
}

TEST(ChannelRecognition, LeavesAUnitOpenThatNothingTells) {
  const Recognition r = recognised(log_of({{"p", {-0.2, 0.0, 0.3}}, {"phi", {0.1, 0.2, 0.3}}, {"V", {20, 21, 22}}}));
  for (const char* channel : {"gyro_x", "roll", "airspeed"}) EXPECT_EQ(unit_of(r, channel), "?") << channel;
  EXPECT_EQ(r.found[0].why, "-0.2 to 0.3: rad/s or deg/s?");
}

TEST(ChannelRecognition, TakesAUnitThatTheNumbersProve) {
  const Recognition r =
      recognised(log_of({{"ax", {0.1, 0.2, 0.1}}, {"az", {-1.0, -1.02, -0.9}}, {"psi", {0, 180, 359}}}));
  EXPECT_EQ(unit_of(r, "yaw"), "deg");
  EXPECT_EQ(unit_of(r, "accel_z"), "g");
  EXPECT_EQ(unit_of(r, "accel_x"), "g");
  EXPECT_EQ(unit_of(recognised(log_of({{"az", {-9.8, -9.7, -9.9}}})), "accel_z"), "m/s^2");
  // 5 is neither.
  EXPECT_EQ(unit_of(recognised(log_of({{"az", {-5, -5, -5}}})), "accel_z"), "?");
}

Channel with_unit(const std::string& name, const std::string& unit, double number) {
  const Unit read = parse_unit(unit);
  return {name, read.si(), unit, make_time_base({0.0, 1.0}), {read.to_si(number), read.to_si(number)}};
}

TEST(ChannelRecognition, TakesACapitalWhereTheUnitTells) {
  Recording log;
  log.add(with_unit("P", "deg/s", 180.0));
  EXPECT_EQ(recognised(log).found.front().channel, "gyro_x");
  Recording pressure;
  pressure.add(with_unit("P", "Pa", 1e5));
  EXPECT_TRUE(recognised(pressure).found.empty());
  EXPECT_TRUE(recognised(log_of({{"P", {1, 2, 3}}})).found.empty());
}

TEST(ChannelRecognition, TakesOfTwoMeaningsOfAUnitTheChannels) {
  Recording log;
  log.add(with_unit("ax", "G", 2.0));
  const MappedRecording mapped = with_recognised_channels({}, log, kRecognisable, kOtherNames, StudyTable("data.map"));
  EXPECT_NEAR(mapped.recording.at("accel_x").value[0], 19.6133, 1e-12);
  EXPECT_THAT(mapped.origins.front().note, HasSubstr("in g: the meaning of 'G' here"));
}

TEST(ChannelRecognition, TakesHalfTheDifferenceOfAPair) {
  const std::array<StandardChannel, 1> surfaces{{{"aileron", "rad"}}};
  const std::array<ChannelAlias, 1> pair{
      {{"rightaileron", "aileron", "half of right less left", false, "leftaileron"}}};
  Recording log;
  log.add(with_unit("Left Aileron", "rad", 0.3));
  EXPECT_TRUE(recognise_channels(log, {}, surfaces, pair).found.empty()) << "one alone is no aileron";
  log.add(with_unit("Right Aileron", "rad", -0.1));
  const MappedRecording mapped = with_recognised_channels({}, log, surfaces, pair, StudyTable("data.map"));
  EXPECT_NEAR(mapped.recording.at("aileron").value[0], -0.2, 1e-15);
  EXPECT_EQ(mapped.origins.front().source, "Right Aileron, Left Aileron");
  EXPECT_THAT(map_section(log, {}, surfaces, pair),
              HasSubstr("aileron = { channels = [\"Right Aileron\", \"Left Aileron\"], weights = [0.5, -0.5] }"));
}

TEST(ChannelRecognition, ReadsTheUnitAtTheEndOfAName) {
  const Recognition r = recognised(log_of({{"p_deg_s", {1, 2, 3}}, {"V_mps", {1, 2, 3}}, {"phi_m", {1, 2, 3}}}));
  EXPECT_EQ(unit_of(r, "gyro_x"), "deg/s");
  EXPECT_EQ(unit_of(r, "airspeed"), "m/s");
  // Metres are no angle.
  EXPECT_EQ(unit_of(r, "roll"), "not found");
  EXPECT_THAT(r.others, ElementsAre("phi_m"));
  const MappedRecording taken = with_recognised_channels({}, log_of({{"p_dps", {180, 0, 0}}, {"ax_g", {1, 1, 1}}}),
                                                         kRecognisable, kOtherNames, StudyTable("data.map"));
  EXPECT_NEAR(taken.recording.at("gyro_x").value[0], std::numbers::pi, 1e-15);
  EXPECT_EQ(taken.origins.front().note, "by its name, in deg/s: by the end of its name");
  EXPECT_THAT(taken.notes, ElementsAre(HasSubstr("without a unit and so not taken: ax_g (accel_x)")));
}

TEST(ChannelRecognition, TellsOneLetterFromItsCapital) {
  EXPECT_EQ(unit_of(recognised(log_of({{"v", {1, 2, 3}}, {"P", {1, 2, 3}}})), "airspeed"), "not found");
}

TEST(ChannelRecognition, LeavesANameThatMayMeanTwoThingsToTheStudy) {
  constexpr std::array<ChannelAlias, 1> kOpen{{{"heading", "yaw", "true or magnetic?", true}}};
  Recording log;
  log.add(make_channel("heading", "rad", make_time_base({0.0, 1.0}), {0.0, 1.0}));
  EXPECT_THAT(map_section(log, {}, kRecognisable, kOpen), HasSubstr("\n# yaw = \"heading\" "));
  const MappedRecording mapped = with_recognised_channels({}, log, kRecognisable, kOpen, StudyTable("data.map"));
  EXPECT_TRUE(mapped.recording.channels().empty());
  EXPECT_THAT(mapped.notes, ElementsAre("heading may be yaw (true or magnetic?): not taken; yaw = \"heading\" in "
                                        "[data.map] takes it"));
}

TEST(ChannelRecognition, WritesTheMapOfAStudy) {
  Recording log = log_of({{"psi", {0, 180, 359}}, {"odd\nname", {1, 2, 3}}});
  log.add(make_channel("p", "rad/s", make_time_base({0.0, 1.0}), {0.0, 1.0}));
  const std::string text = map_section(log, {}, kRecognisable, kOtherNames);
  EXPECT_THAT(text, HasSubstr("yaw = { channel = \"psi\", unit = \"deg\" }"));
  EXPECT_THAT(text, HasSubstr("# 0 to 359: beyond a turn in radians\n"));
  EXPECT_THAT(text, HasSubstr("gyro_x = \"p\" "));
  EXPECT_THAT(text, HasSubstr("# not found: accel_x, accel_z, airspeed, roll\n"));
  EXPECT_THAT(text, HasSubstr("# channels of the log that were not recognised: odd name\n"));
  // What it writes is TOML, and maps.
  const Study study = Study::parse("[map]\n" + text, "s.toml");
  const MappedRecording mapped = with_channel_map({}, log, kRecognisable, study.root().table("map"));
  EXPECT_THAT(mapped.recording.names(), ElementsAre("gyro_x", "yaw"));
}

}  // namespace
}  // namespace veridyn::recording
