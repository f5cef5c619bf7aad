#include "veridyn/live/rig/live_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/live/weaving_drive.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/shown_defaults.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/cueing/platform/platform_file.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;

std::string refusal(const std::string& lines) {
  return why([&] { static_cast<void>(test::rig_study(lines)); });
}

TEST(LiveStudy, ReadsWhereMotionComesFromAndGoesTo) {
  const LiveStudy s = test::rig_study(
      "packet = 'outsim'\nrate = '1 kHz'\ndelay = '15 ms'\nsigns = 'while'\nanswers = false\nsoft_start = 2\n");
  EXPECT_EQ(to_string(s.telemetry), "127.0.0.1:47123");
  EXPECT_EQ(to_string(s.platform), "127.0.0.1:47124");
  ASSERT_EQ(s.layouts.size(), 1U);
  EXPECT_EQ(s.layouts[0].name, "outsim");
  EXPECT_EQ(s.options.rate, 1000.0);
  EXPECT_EQ(s.options.even.delay, 0.015);
  EXPECT_EQ(s.options.signs, SignCheck::kWhile);
  EXPECT_FALSE(s.options.answers);
  EXPECT_EQ(s.options.soft_start, 2.0);
}

TEST(LiveStudy, LooksForEveryPacketThatHoldsAMotion) {
  const LiveStudy s = test::rig_study("");
  EXPECT_GE(s.layouts.size(), 8U);
  for (const io::PacketLayout& layout : s.layouts) EXPECT_NE(layout.name, "outgauge");
}

TEST(LiveStudy, ReadsTheCircuitOfTheVirtualRig) {
  const LiveStudy s =
      test::rig_study("[live.circuit]\nspeed = '2 m/s'\ndirection = 'clockwise'\nradius = '4 m'\nflat = true\n");
  ASSERT_NE(s.circuit, nullptr);
  EXPECT_EQ(s.circuit->options().radius, 4.0);
  EXPECT_EQ(s.circuit_drive.speed, 2.0);
  EXPECT_TRUE(s.circuit_drive.clockwise);
  EXPECT_EQ(test::rig_study("").circuit, nullptr);
  EXPECT_THAT(refusal("[live.circuit]\nradius = '1 m'\n"), HasSubstr("more than 1.5 widths"));
}

TEST(LiveStudy, ARecordingHoldsThePlatformOfAFileByItsNumbers) {
  const veridyn::test::TemporaryFolder folder;
  cueing::Platform measured = cueing::built_in_platform("three_axis");
  measured.axis_actuators[cueing::PlatformAxis::kPitch] = cueing::ActuatorOptions{.omega = 21.5, .zeta = 0.9};
  std::ofstream(folder.path() / "platform.toml") << cueing::platform_file(measured, "");
  const Study study = Study::parse(
      "[cue]\nalgorithms = ['classical']\n[platform]\nfile = 'platform.toml'\npitch_delay = 0.03\n"
      "[live]\ntelemetry = '127.0.0.1:47123'\nplatform = '127.0.0.1:47124'\n",
      "rig.toml", folder.path());
  const LiveStudy live = read_live_study(study);
  const std::string recorded = self_contained(study, live).to_toml();
  std::filesystem::remove(folder.path() / "platform.toml");
  const LiveStudy again = read_live_study(Study::parse(recorded, "run.vlr"));
  EXPECT_EQ(cueing::platform_keys(again.cueing.platform), cueing::platform_keys(live.cueing.platform));
  EXPECT_EQ(again.cueing.platform.response(cueing::PlatformAxis::kPitch).omega, 21.5);
  EXPECT_EQ(again.cueing.platform.response(cueing::PlatformAxis::kPitch).delay, 0.03);
}

TEST(LiveStudy, ShowsDefaultsThatStudiesTake) { veridyn::test::expect_defaults_read_back(study_keys()); }

TEST(LiveStudy, RefusesInOneLineWithItsPlace) {
  EXPECT_THAT(refusal("rate = '10 Hz'\n"), HasSubstr("rig.toml:8: live.rate: = 10 Hz must be from 20 to 4000 Hz"));
  EXPECT_THAT(refusal("delay = '2 s'\n"), HasSubstr("live.delay: = 2 s must be from 0 to 0.5 s"));
  EXPECT_THAT(refusal("packet = 'outgauge'\n"),
              HasSubstr("= 'outgauge' is no known packet with a motion (any, outsim,"));
  EXPECT_THAT(refusal("signs = 'never'\n"), HasSubstr("rig.toml:8"));
  EXPECT_THAT(refusal("[live.packet]\nsize = 12\n[[live.packet.field]]\nname = 'time'\noffset = 0\n"
                      "[[live.packet.field]]\nname = 'speed'\noffset = 2\n"),
              HasSubstr("'speed' at 2 overlaps 'time'"));
  EXPECT_THAT(refusal("[live.packet]\nsize = 12\n[[live.packet.field]]\nname = 'time'\noffset = 0\n"
                      "[[live.packet.field]]\nname = 'speed'\noffset = 10\n"),
              HasSubstr("'speed' ends at 14, the packet at 12"));
}

TEST(LiveStudy, RefusesAnAddressThatIsNone) {
  for (const char* text : {"", "127.0.0.1", "127.0.0.1:0", "127.0.0.1:65536", "localhost:80", "256.0.0.1:80",
                           "127.0.0.1:80x", "127.0.0:80", "1.2.3.4.5:80"})
    EXPECT_THAT(why([&] { static_cast<void>(parse_address(text, "live.telemetry")); }),
                HasSubstr("is no address: takes four numbers and a port"))
        << text;
  EXPECT_EQ(parse_address("0.0.0.0:4123", ""), (Sender{0, 4123}));
}

TEST(LiveStudy, ReadsHowOrdersAreWritten) {
  const LiveStudy text = test::rig_study("format = 'flypt'\nanswers = false\ntext = '{pitch:deg:.1f}'\n");
  EXPECT_EQ(text.format.kind, OrderFormatKind::kFlypt);
  EXPECT_EQ(text.format.text, "{pitch:deg:.1f}");
  EXPECT_EQ(platform_name(text), "127.0.0.1:47124");
  EXPECT_THAT(refusal("format = 'motion_68'\n"),
              HasSubstr("live.answers: must be false: a platform of format 'motion_68' does not answer orders"));
  EXPECT_THAT(refusal("format = 'flypt'\nanswers = false\ntext = '{pitsch}'\n"),
              HasSubstr("rig.toml:10: live.text: flypt: {pitsch} is no axis"));
  EXPECT_THAT(refusal("text = 'x'\n"), HasSubstr("live.text: is of 'flypt'; format is 'veridyn'"));
  EXPECT_THAT(refusal("format = 'flyp'\nanswers = false\n"), HasSubstr("live.format"));
  EXPECT_THAT(refusal("baud = 9600\n"), HasSubstr("live.baud: is of a serial line; the platform has an address"));
}

TEST(LiveStudy, OrdersMayGoOnASerialLine) {
  const auto study = [](const std::string& lines) {
    return read_live_study(
        Study::parse("[cue]\nalgorithms = ['classical']\n[platform]\nsubject = 'hexapod'\n[live]\n"
                     "telemetry = '127.0.0.1:47123'\nplatform = '/dev/ttyUSB0'\n" +
                         lines,
                     "rig.toml"));
  };
  const LiveStudy s = study("format = 'amc_aasd15a'\nanswers = false\n");
  EXPECT_EQ(platform_name(s), "/dev/ttyUSB0");
  EXPECT_EQ(s.platform_line.baud, 250000);
  EXPECT_THAT(why([&] { static_cast<void>(study("")); }), HasSubstr("'veridyn' takes an address"));
  EXPECT_THAT(
      why([&] { static_cast<void>(study("format = 'amc_aasd15a'\nanswers = false\nbaud = 9600\nrate = '100 Hz'\n")); }),
      HasSubstr("live.rate: is 100 Hz; 9600 bit/s carry 48 orders of 20 bytes a second"));
}

TEST(LiveStudy, DoesNotGuessThePlatformsLimits) {
  EXPECT_THAT(why([] {
                static_cast<void>(read_live_study(
                    Study::parse("[cue]\n[live]\ntelemetry = '127.0.0.1:1'\nplatform = '127.0.0.1:2'\n", "rig.toml")));
              }),
              HasSubstr("platform: is missing: the limits of a platform that moves are not guessed"));
}

TEST(LiveStudy, NeedsItsTableAndOneAlgorithm) {
  EXPECT_THAT(why([] { static_cast<void>(read_live_study(Study::parse("[cue]\n", "rig.toml"))); }),
              HasSubstr("the table [live] says where telemetry comes from"));
  EXPECT_THAT(why([] {
                static_cast<void>(read_live_study(
                    Study::parse("[cue]\nalgorithms = ['classical', 'tilt']\n[platform]\nsubject = "
                                 "'three_axis'\n[live]\ntelemetry = '127.0.0.1:1'\nplatform = '127.0.0.1:2'\n",
                                 "rig.toml")));
              }),
              HasSubstr("names 2; a platform follows one"));
  EXPECT_THAT(why([] {
                static_cast<void>(read_live_study(
                    Study::parse("[cue]\nforesee = 'lap'\n[platform]\nsubject = 'three_axis'\n[live]\ntelemetry = "
                                 "'127.0.0.1:1'\nplatform = '127.0.0.1:2'\n",
                                 "rig.toml")));
              }),
              HasSubstr("foresee"));
}

}  // namespace
}  // namespace veridyn::live
