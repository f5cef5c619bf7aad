#include "veridyn/aircraft/sensors/channel_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/sensors/mapped_log.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::channel;
using aircraft::testing::log_with;
using aircraft::testing::map;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ChannelMap, KeepsStandardNamesAsTheyAre) {
  const MappedRecording mapped = map(log_with({channel("airspeed", "m/s", {15, 16}), channel("other", "m", {1, 2})}));
  EXPECT_EQ(mapped.recording.names(), std::vector<std::string>{"airspeed"});
  EXPECT_EQ(mapped.log_kind, "standard names");
}

TEST(ChannelMap, AppliesZeroScaleUnitAndDelayOfTheStudy) {
  const MappedRecording mapped =
      map(log_with({channel("CUR2.Volt", "1", {2.5, 3.5})}),
          "alpha = { channel = \"CUR2.Volt\", zero = 2.5, scale = 10, unit = \"deg\", delay = \"20 ms\" }\n");
  const Channel& alpha = mapped.recording.at("alpha");
  EXPECT_THAT(alpha.value, ElementsAre(0.0, DoubleNear(10.0 * kDegree, 1e-15)));
  EXPECT_THAT(alpha.times()[1], DoubleNear(0.08, 1e-15));
}

TEST(ChannelMap, CombinesChannelsByWeight) {
  const MappedRecording mapped =
      map(log_with({channel("l", "1", {0.2, 0.1}), channel("r", "1", {0.0, -0.1})}),
          "aileron = { channels = [\"l\", \"r\"], weights = [0.5, -0.5], unit = \"rad\" }\n");
  EXPECT_THAT(mapped.recording.at("aileron").value, ElementsAre(DoubleNear(0.1, 1e-15), DoubleNear(0.1, 1e-15)));
}

TEST(ChannelMap, SwitchesBetweenChannelsByMode) {
  const MappedRecording mapped =
      map(log_with({channel("mode", "1", {1, 2, 0}), channel("stick", "1", {0.1, 0.1, 0.1}),
                    channel("autopilot", "1", {0.3, 0.3, 0.3})}),
          "elevator = { switch = \"mode\", cases = { 1 = \"stick\", 2 = \"autopilot\" }, unit = \"rad\" }\n");
  const Channel& elevator = mapped.recording.at("elevator");
  EXPECT_DOUBLE_EQ(elevator.value[0], 0.1);
  EXPECT_DOUBLE_EQ(elevator.value[1], 0.3);
  EXPECT_TRUE(std::isnan(elevator.value[2]));
}

TEST(ChannelMap, TakesAChannelAwayOnRequest) {
  const MappedRecording mapped =
      map(log_with({channel("alpha", "rad", {0, 1}), channel("beta", "rad", {0, 1})}), "beta = \"none\"\n");
  EXPECT_EQ(mapped.recording.names(), std::vector<std::string>{"alpha"});
}

TEST(ChannelMap, SaysWhatIsWrongWithAMapping) {
  const Recording log = log_with({channel("ARSP.Airspeed", "m/s", {15, 16}), channel("RCOU.C2", "1", {1500, 1600})});
  EXPECT_EQ(why([&] { map(log, "airspede = \"ARSP.Airspeed\"\n"); }),
            "study.toml:2: map.airspede: is not a standard channel (did you mean 'airspeed'?)");
  EXPECT_EQ(why([&] { map(log, "airspeed = \"ARSP.Airsped\"\n"); }),
            "study.toml:2: map.airspeed: flight.bin has no channel 'ARSP.Airsped' (did you mean 'ARSP.Airspeed'?)");
  EXPECT_EQ(why([&] { map(log, "alpha = \"ARSP.Airspeed\"\n"); }),
            "study.toml:2: map.alpha: channel 'ARSP.Airspeed' is in [m/s], but alpha is in [rad]");
  EXPECT_THAT(why([&] { map(log, "alpha = { channel = \"RCOU.C2\", unit = \"kg\" }\n"); }),
              HasSubstr("study.toml:2: map.alpha.unit: unit 'kg' is a mass [kg], expected an angle [rad]"));
}

TEST(ChannelMap, KnowsTheNamesOfTheLiteratureWhereTheUnitIsKnown) {
  const MappedRecording mapped = map(log_with({channel("p", "rad/s", {0.1, 0.2}), channel("q", "1", {0.1, 0.2}),
                                               channel("de", "rad", {0.1, 0.2}), channel("V", "m/s", {30, 31})}));
  EXPECT_THAT(mapped.recording.names(), ElementsAre("gyro_x", "airspeed", "elevator"));
  EXPECT_THAT(mapped.notes, ::testing::Contains(HasSubstr("without a unit and so not taken: q (gyro_y)")));
}

// Names as JSBSim 1.3.3 and X-Plane 11 write them.
TEST(ChannelMap, KnowsTheNamesOfSimulatorsByTheirUnits) {
  const MappedRecording jsbsim = map(log_with(
      {channel("P", "rad/s", {0.5, 0.5}), channel("V_{Total}", "m/s", {30, 30}),
       channel("V_{Inertial}", "m/s", {400, 400}), channel("BodyAccel_Z", "m/s^2", {-9.8, -9.8}),
       channel("Altitude ASL", "m", {1000, 1000}), channel("P_{Ambient}", "Pa", {90000, 90000}),
       channel("Left Aileron Position", "rad", {0.1, 0.1}), channel("Right Aileron Position", "rad", {-0.1, -0.1}),
       channel("Elevator Position", "rad", {0.2, 0.2}), channel("Rudder Position", "rad", {0.3, 0.3})}));
  const std::pair<const char*, double> expected[] = {
      {"gyro_x", 0.5},   {"airspeed", 30.0}, {"accel_z", -9.8}, {"alt", 1000.0}, {"static_pressure", 90000.0},
      {"aileron", -0.1}, {"elevator", 0.2},  {"rudder", 0.3}};
  for (const auto& [name, value] : expected) EXPECT_EQ(jsbsim.recording.at(name).value[0], value) << name;
  const MappedRecording xplane =
      map(log_with({channel("__P,rad/s", "rad/s", {0.5, 0.5}), channel("_Vind,_kias", "m/s", {40, 40}),
                    channel("Vtrue,_ktas", "m/s", {50, 50}), channel("alpha,__deg", "rad", {0.1, 0.1})}));
  EXPECT_EQ(xplane.recording.at("gyro_x").value[0], 0.5);
  EXPECT_EQ(xplane.recording.at("airspeed").value[0], 50.0);
  EXPECT_EQ(xplane.recording.at("alpha").value[0], 0.1);
}

TEST(ChannelMap, TakesUnitsThatTheStudyDeclares) {
  const Recording log =
      log_with({channel("p", "1", {90, 180}), channel("alpha", "1", {9, 18}), channel("az", "1", {-1, -2})});
  const MappedRecording mapped = map(log, "units = [\"deg\", \"deg/s\"]\n");
  EXPECT_NEAR(mapped.recording.at("gyro_x").value[1], kPi, 1e-12);
  EXPECT_NEAR(mapped.recording.at("alpha").value[1], 0.1 * kPi, 1e-12);
  EXPECT_FALSE(mapped.recording.has("accel_z"));
  EXPECT_EQ(map(log, "units = \"SI\"\n").recording.at("accel_z").value[1], -2.0);
  EXPECT_NEAR(map(log, "units = \"deg/s\"\ngyro_z = \"p\"\n").recording.at("gyro_z").value[0], 0.5 * kPi, 1e-12);
  EXPECT_THAT(why([&] { static_cast<void>(map(log, "units = [\"dgs\"]\n")); }), HasSubstr("map.units"));
}

TEST(ChannelMap, RefusesAFrameWithZUp) {
  Recording log = log_with({channel("airspeed", "m/s", {1, 2})});
  log.frame = Frame::kFlu;
  EXPECT_THAT(why([&] { map(log); }), HasSubstr("its frame is flu"));
}

TEST(ChannelMap, ListsWhatALogHasWhenSomethingIsMissing) {
  const MappedRecording mapped = map(log_with({channel("airspeed", "m/s", {15, 16})}));
  const std::vector<std::string> needed{"gyro_x", "airspeed"};
  EXPECT_EQ(why([&] { require_channels(mapped, needed, "the rates"); }),
            "flight.bin: has no gyro_x (standard names log), which is needed for the rates; it has airspeed");
}

}  // namespace
}  // namespace veridyn::aircraft
