#include "veridyn/io/dataflash/dataflash_text.hpp"

#include <cmath>

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::message_of;
using testing::shared_flight;

TEST(DataFlashText, ReadsALogOfOldFirmware) {
  const Log log = read_dataflash_text(testing::small_dataflash_text(), "old.log");
  EXPECT_EQ(log.damage.records_lost, 0U);
  const Recording recording = to_recording(log);
  EXPECT_NEAR(recording.at("ATT.Roll").value[0], 12.34 * kDegree, 1e-12);
  EXPECT_NEAR(recording.at("ATT.Pitch").value[1], -5.60 * kDegree, 1e-12);
  EXPECT_NEAR(recording.at("IMU.AccZ").times()[1], 1.02, 1e-12);
  EXPECT_DOUBLE_EQ(recording.parameters.at("SYSID_SW_MREV"), 120.0);
  EXPECT_TRUE(std::isnan(recording.parameters.at("COMPASS_MOT_X")));
  EXPECT_EQ(recording.information.at("vehicle"), "ArduPlane");
  EXPECT_EQ(recording.events[0].text, "ArduPlane V2.74b (681dafcf), a text, with commas");
  EXPECT_EQ(recording.events[1].text, "FBWA");
}

TEST(DataFlashText, TakesTheClockOfOldGpsMessagesFromT) {
  const Log log = read_dataflash_text(testing::small_dataflash_text(), "old.log");
  EXPECT_NEAR(log.find("GPS")->time->at(0), 1.010, 1e-12);
  EXPECT_NEAR(to_recording(log).at("GPS.Lat").value[0], -37.9596764 * kDegree, 1e-12);
}

TEST(DataFlashText, ReadsUnitsAndInstancesOfNewLogsWithUnitIdsAsLettersOrCodes) {
  const std::string formats =
      "FMT, 131, 40, IMU, QBfh, TimeUS,I,GyrX,Mag\n"
      "FMT, 218, 44, FMTU, QBNN, TimeUS,FmtType,UnitIds,MultIds\n"
      "FMT, 219, 76, UNIT, QbZ, TimeUS,Id,Label\n"
      "FMT, 220, 20, MULT, Qbd, TimeUS,Id,Mult\n"
      "FMTU, 1, 131, s#kG, F-0C\n"
      "IMU, 1000000, 0, 90, 250\n"
      "IMU, 1000001, 1, 45, 250\n";
  for (const char* ids : {"UNIT, 1, 107, deg/s\nUNIT, 1, 71, Gauss\nMULT, 1, 67, 0.001\n",
                          "UNIT, 1, k, deg/s\nUNIT, 1, G, Gauss\nMULT, 1, C, 0.001\n"}) {
    const Recording recording = to_recording(read_dataflash_text(formats + ids, "new.log"));
    EXPECT_NEAR(recording.at("IMU.GyrX").value[0], 90.0 * kDegree, 1e-12);
    EXPECT_NEAR(recording.at("IMU[1].GyrX").value[0], 45.0 * kDegree, 1e-12);
    EXPECT_NEAR(recording.at("IMU.Mag").value[0], 250e-3 * 1e-4, 1e-15);
  }
}

TEST(DataFlashText, CountsLinesThatCannotBeRead) {
  const std::string good = testing::small_dataflash_text();
  const Log log =
      read_dataflash_text(good + "IMU, 1040, 0.5\nIMU, 1050, a, b, c, d, e, f\nWHAT, 1, 2\nIMU, 10", "x.log");
  EXPECT_EQ(log.damage.records_lost, 4U);
  EXPECT_EQ(log.find("IMU")->size(), 2U);
  EXPECT_THAT(log.damage.notes, Contains("the log ends in the middle of a line"));
}

TEST(DataFlashText, SaysWhatIsWrongWithAFileThatIsNone) {
  EXPECT_EQ(message_of([] { (void)read_dataflash_text("a,b\n1,2\n", "x.log"); }),
            "x.log: not an ArduPilot text log: no line starts with 'FMT,'");
}

// Counts by grep over the file, e.g. grep -c '^IMU,'.
TEST(RealDataFlashText, ReadsTheExcerptOfACopterLogWithPreambleEmptyFormatsAndNan) {
  const auto path = shared_flight("ardupilot/arducopter_nan_excerpt.log");
  VERIDYN_NEEDS_SHARED(path);
  const Log log = read_dataflash_text(read_file(path), path.string());
  EXPECT_EQ(log.information.at("vehicle"), "ArduCopter");
  EXPECT_TRUE(std::isnan(log.parameters.at("COMPASS_MOT_X")));
  EXPECT_DOUBLE_EQ(log.parameters.at("LOG_BITMASK"), -22530.0);
  const std::string content = read_file(path);
  for (const char* name : {"IMU", "IMU2", "ATT", "RCIN", "RCOU", "GPS", "PARM", "MSG"}) {
    std::size_t lines = 0;
    for (std::size_t at = content.find(std::string("\n") + name + ","); at != std::string::npos;
         at = content.find(std::string("\n") + name + ",", at + 1)) {
      ++lines;
    }
    EXPECT_EQ(log.count(name), lines) << name;
  }
}

}  // namespace
}  // namespace veridyn::io
