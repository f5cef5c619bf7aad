#include "veridyn/io/dataflash/dataflash_schema.hpp"

#include <numbers>

#include "tests/io/dataflash/small_recording.hpp"
#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/dataflash/dataflash.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using testing::DataFlashWriter;
using ::testing::HasSubstr;
using testing::shared_flight;
using testing::small_dataflash_recording;

TEST(DataFlash, GivesValuesInSiUnitsWhateverFormatCharacterAndMultiplierSay) {
  const Recording recording = small_dataflash_recording();
  // Character c holds hundredths, and MULT says 0.01 as well: only one of them counts.
  EXPECT_NEAR(recording.at("ATT.Roll").value[0], 12.34 * kDegree, 1e-12);
  EXPECT_NEAR(recording.at("ATT.Pitch").value[0], -5.67 * kDegree, 1e-12);
  EXPECT_NEAR(recording.at("ATT.Yaw").value[0], 359.99 * kDegree, 1e-12);
  EXPECT_EQ(recording.at("ATT.Roll").unit.name, "rad");
  EXPECT_EQ(recording.at("ATT.Roll").recorded_unit, "deg");
  // Character L holds 1e-7 degrees, MULT the same.
  EXPECT_NEAR(recording.at("GPS.Lat").value[0], -37.9596764 * kDegree, 1e-12);
  EXPECT_NEAR(recording.at("GPS.Alt").value[0], 15.78, 1e-12);
  // A plain integer with MULT 1e-3 and unit gauss: 250 mG = 25 microtesla.
  EXPECT_NEAR(recording.at("GPS.MagX").value[0], 250e-3 * 1e-4, 1e-15);
  EXPECT_NEAR(recording.at("BARO.Temp").value[0], 21.5 + 273.15, 1e-9);
  // Not a time stamp, but a time: microseconds by MULT.
  EXPECT_NEAR(recording.at("BARO.SMS").value[1], 1.04, 1e-12);
  EXPECT_NEAR(recording.at("IMU.GyrX").value[0], 0.5, 0.0);
}

TEST(DataFlash, SplitsInstancesAndSharesTheTimeBaseOfAMessage) {
  const Recording recording = small_dataflash_recording();
  EXPECT_EQ(recording.at("IMU.AccZ").size(), 8U);
  EXPECT_EQ(recording.at("IMU[1].AccZ").size(), 8U);
  EXPECT_DOUBLE_EQ(recording.at("IMU[1].AccZ").value[0], -9.5);
  EXPECT_NEAR(recording.at("IMU[1].AccZ").times()[1], 1.02001, 1e-12);
  EXPECT_EQ(recording.at("IMU.AccZ").time, recording.at("IMU.GyrX").time);
  EXPECT_FALSE(recording.has("IMU.I"));
  EXPECT_FALSE(recording.has("IMU.TimeUS"));
}

TEST(DataFlash, KnowsTheUnitsOfStandardMessagesInLogsWithoutUnitRecords) {
  DataFlashWriter log;
  log.format(130, "IMU2", "Qff", "TimeUS,GyrX,AccZ");
  log.format(131, "ATT", "Qcf", "TimeUS,Roll,Pitch");
  log.format(132, "MINE", "Qf", "TimeUS,Roll");
  log.record("IMU2", {1e6, 0.5, -9.75});
  log.record("ATT", {1e6, 90.0, 45.0});
  log.record("MINE", {1e6, 45.0});
  const Recording recording = to_recording(read_dataflash(log.bytes(), "old.bin"));
  EXPECT_EQ(recording.at("IMU2.GyrX").unit.name, "rad/s");
  EXPECT_NEAR(recording.at("ATT.Roll").value[0], std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(recording.at("ATT.Pitch").value[0], std::numbers::pi / 4, 1e-12);
  EXPECT_DOUBLE_EQ(recording.at("MINE.Roll").value[0], 45.0);
}

TEST(DataFlash, AdvancesByTheLengthOfTheFormatWhereTheColumnsSumToSomethingElse) {
  DataFlashWriter log;
  log.format(130, "CAM", "Qff", "TimeUS,A,B", 25);   // 19 by its columns: six bytes more
  log.format(131, "BAR3", "Qff", "TimeUS,A,B", 15);  // 19 by its columns: B does not fit
  for (int i = 0; i < 4; ++i) {
    log.record("CAM", {1e6 + i, 1.0 + i, 2.0});
    log.record("BAR3", {1e6 + i, 3.0 + i, 4.0});
  }
  const Log result = read_dataflash(log.bytes(), "odd.bin");
  EXPECT_EQ(result.damage.bytes_lost, 0U);
  EXPECT_EQ(result.find("CAM")->size(), 4U);
  EXPECT_DOUBLE_EQ(result.find("CAM")->find("B")->value(3), 2.0);
  EXPECT_DOUBLE_EQ(result.find("BAR3")->find("A")->value(3), 6.0);
  EXPECT_EQ(result.find("BAR3")->find("B"), nullptr);
  EXPECT_THAT(result.damage.notes, Contains(HasSubstr("CAM 25/19, BAR3 15/19")));
}

// Numbers of an independent decoder, as in dataflash_test.cpp.
TEST(RealDataFlash, UnitsOfAnOldLogComeFromTheTableOfKnownMessages) {
  const auto path = shared_flight("ardupilot/pymavlink_test.BIN");
  VERIDYN_NEEDS_SHARED(path);
  const Recording recording = to_recording(read_dataflash(read_file(path), path.string()));
  EXPECT_NEAR(recording.at("IMU.GyrX").value.front(), -0.1165708526968956, 1e-12);
  EXPECT_EQ(recording.at("IMU.GyrX").unit.name, "rad/s");
  EXPECT_NEAR(recording.at("ATT.Pitch").value.front(), 2.58 * kDegree, 1e-12);
  EXPECT_NEAR(recording.at("GPS.Lat").value.front(), -35.3626277 * kDegree, 1e-12);
  EXPECT_NEAR(recording.at("RCOU.C1").value.front(), 1560e-6, 1e-15);
  EXPECT_NEAR(recording.at("NKF1.Yaw").value.front(), 337.09 * kDegree, 1e-12);
}

}  // namespace
}  // namespace veridyn::io
