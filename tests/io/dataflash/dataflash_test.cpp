#include "veridyn/io/dataflash/dataflash.hpp"

#include <map>

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using testing::DataFlashWriter;
using ::testing::HasSubstr;
using testing::message_of;
using testing::shared_flight;

TEST(DataFlash, IsNotHeldUpByALengthBelowThree) {
  for (const int length : {1, 2}) {
    DataFlashWriter log;
    log.format(130, "BAD", "B", "X", static_cast<std::uint8_t>(length));
    log.raw(std::string_view("\xA3\x95\x82\xA3\x95\x82", 6));
    log.format(131, "GOOD", "Qf", "TimeUS,X");
    log.record("GOOD", {1e6, 7.0});
    const Log result = read_dataflash(log.bytes(), "short.bin");
    EXPECT_EQ(result.damage.bytes_lost, 6U);
    EXPECT_DOUBLE_EQ(result.find("GOOD")->find("X")->value(0), 7.0);
  }
}

TEST(DataFlash, FindsFormatsThatStandAfterTheFirstRecordsOfTheirType) {
  DataFlashWriter log(false);
  DataFlashWriter formats;
  formats.format(130, "ATT", "Qf", "TimeUS,Roll");
  log.format(130, "ATT", "Qf", "TimeUS,Roll");
  const std::size_t format_size = log.bytes().size();
  log.record("ATT", {1e6, 1.0});
  log.record("ATT", {2e6, 2.0});
  const Log result = read_dataflash(log.bytes().substr(format_size) + formats.bytes(), "late.bin");
  EXPECT_EQ(result.damage.bytes_lost, 0U);
  EXPECT_EQ(result.find("ATT")->size(), 2U);
}

TEST(DataFlash, ResynchronisesAfterRubbishAndCountsItExactly) {
  DataFlashWriter log;
  log.format(130, "ATT", "Qf", "TimeUS,Roll");
  for (int i = 0; i < 10; ++i) log.record("ATT", {1e6 + 1e4 * i, 1.0 * i});
  log.raw(std::string(100, '\xA3') + std::string("\xA3\x95\x99", 3) + std::string(425, '\xFF'));
  for (int i = 10; i < 20; ++i) log.record("ATT", {1e6 + 1e4 * i, 1.0 * i});
  log.raw(std::string(528, '\x5A'));
  const Log result = read_dataflash(log.bytes(), "rubbish.bin");
  EXPECT_EQ(result.damage.bytes_lost, 528U + 528U);
  EXPECT_EQ(result.damage.records_lost, 2U);
  ASSERT_EQ(result.find("ATT")->size(), 20U);
  EXPECT_DOUBLE_EQ(result.find("ATT")->find("Roll")->value(19), 19.0);
}

TEST(DataFlash, LosesOnlyTheRecordThatWasCutShort) {
  DataFlashWriter log;
  log.format(130, "ATT", "Qff", "TimeUS,Roll,Pitch");
  for (int i = 0; i < 5; ++i) log.record("ATT", {1e6 + 1e4 * i, 1.0 * i, 0.0});
  std::string bytes = log.bytes();
  bytes.erase(bytes.size() - 2 * 19 - 6, 6);  // the third of five loses its last six bytes
  const Log result = read_dataflash(bytes, "cut.bin");
  EXPECT_EQ(result.find("ATT")->size(), 4U);
  EXPECT_EQ(result.damage.bytes_lost, 13U);
  EXPECT_EQ(result.damage.records_lost, 1U);
}

TEST(DataFlash, DropsSpikesOfTheClockAndCountsDoubledStamps) {
  DataFlashWriter log;
  log.format(130, "ATT", "Qf", "TimeUS,Roll");
  for (int i = 0; i < 40; ++i) {
    double t = 1e6 + 1e4 * i;
    if (i == 10) t = 1e15;
    if (i == 20) t -= 1e4;
    log.record("ATT", {t, 1.0 * i});
  }
  log.record("ATT", {9e14, 99.0});  // the last one cannot be judged by what follows
  const Log result = read_dataflash(log.bytes(), "spikes.bin");
  const LogTopic& attitude = *result.find("ATT");
  EXPECT_EQ(attitude.size(), 39U);
  EXPECT_EQ(attitude.spikes, 2U);
  EXPECT_EQ(attitude.doubled, 1U);
  EXPECT_DOUBLE_EQ(attitude.find("Roll")->value(10), 11.0);
  EXPECT_THAT(result.damage.notes, Contains(HasSubstr("2 samples dropped")));
}

TEST(DataFlash, SaysWhatIsWrongWithAFileThatIsNone) {
  EXPECT_EQ(message_of([] { (void)read_dataflash("", "a.bin"); }), "a.bin: the file is empty");
  EXPECT_EQ(message_of([] { (void)read_dataflash("hello", "a.bin"); }),
            "a.bin: not an ArduPilot DataFlash log: no FMT record (A3 95 80) in it");
}

struct RealLog {
  const char* file;
  std::size_t lost;
  std::size_t parameters;
  std::map<std::string, std::size_t> counts;
};

void check_counts(const RealLog& expected) {
  const auto path = shared_flight(expected.file);
  VERIDYN_NEEDS_SHARED(path);
  const Log log = read_dataflash(read_file(path), path.string());
  EXPECT_EQ(log.damage.bytes_lost, expected.lost);
  EXPECT_EQ(log.parameters.size(), expected.parameters);
  std::map<std::string, std::size_t> counts;
  for (const LogTopic& topic : log.topics) counts[topic.name] += topic.size() + topic.spikes;
  EXPECT_EQ(counts, expected.counts);
}

// All numbers of real logs below come from an independent decoder: 20 lines of Python that walk the file record by
// record with struct.unpack, and count.
TEST(RealDataFlash, EveryRecordOfALogWithSensorsMissingIsDecoded) {
  check_counts(
      {"ardupilot/center_0003.bin",
       0,
       1081,
       {{"AHR2", 891},  {"ATT", 1037},  {"DSF", 46},    {"EV", 1},      {"FILE", 311},  {"FMT", 161},   {"FMTU", 161},
        {"GPA", 209},   {"GPS", 209},   {"MAG", 465},   {"MAV", 135},   {"MODE", 1},    {"MSG", 11},    {"MULT", 14},
        {"ORGN", 1},    {"PARM", 1083}, {"PIDP", 1037}, {"PIDR", 1037}, {"PIDS", 1036}, {"PIDY", 1036}, {"POS", 916},
        {"STAK", 438},  {"STAT", 231},  {"TERR", 41},   {"UBX2", 7},    {"UNIT", 34},   {"VER", 1},     {"XKF1", 1034},
        {"XKF2", 1034}, {"XKF3", 1033}, {"XKF4", 1032}, {"XKF5", 1032}, {"XKFS", 1032}, {"XKQ", 1032},  {"XKT", 9},
        {"XKV1", 92},   {"XKV2", 92}}});
}

TEST(RealDataFlash, EveryRecordOfALogOf43KindsIsDecoded) {
  check_counts(
      {"ardupilot/test_log_pilot_position.BIN",
       18,
       1102,
       {{"AETR", 1291}, {"AHR2", 1260}, {"AOA", 1291},  {"ARSP", 516},  {"ATT", 1292},  {"BARO", 531},  {"CTUN", 1291},
        {"DSF", 51},    {"FMT", 174},   {"FMTU", 174},  {"GPA", 257},   {"GPS", 257},   {"IMU", 2584},  {"IMU2", 2584},
        {"MAG", 518},   {"MAG2", 518},  {"MAV", 204},   {"MODE", 4},    {"MSG", 43},    {"MULT", 14},   {"NKF1", 1267},
        {"NKF2", 1267}, {"NKF3", 1267}, {"NKF4", 1266}, {"NKF5", 1266}, {"NKF6", 1266}, {"NKF7", 1266}, {"NKF8", 1266},
        {"NKF9", 1266}, {"NKQ1", 1266}, {"NKQ2", 1266}, {"NKT1", 11},   {"NKT2", 11},   {"NTUN", 1291}, {"ORGN", 1},
        {"PARM", 1128}, {"PIDP", 1292}, {"PIDR", 1292}, {"PIDS", 1292}, {"PIDY", 1292}, {"POS", 1286},  {"RCIN", 1291},
        {"RCOU", 1291}, {"RPM", 516},   {"STAT", 258},  {"TERR", 51},   {"UBX1", 11},   {"UBX2", 11},   {"UNIT", 31},
        {"VIBE", 1291}, {"XKF1", 1266}, {"XKF2", 1266}, {"XKF3", 1266}, {"XKF4", 1266}, {"XKF5", 1266}, {"XKF6", 1266},
        {"XKF7", 1266}, {"XKF8", 1266}, {"XKF9", 1266}, {"XKQ1", 1266}, {"XKQ2", 1266}, {"XKT1", 11},   {"XKT2", 11},
        {"XKV1", 98},   {"XKV2", 98}}});
}

TEST(RealDataFlash, EveryRecordOfALogWithoutUnitsIsDecoded) {
  check_counts(
      {"ardupilot/pymavlink_test.BIN",
       24,
       809,
       {{"AETR", 23}, {"AHR2", 23}, {"AOA", 23},  {"ATT", 24},  {"BARO", 8},  {"BAT", 8},   {"CMD", 12},  {"CTUN", 23},
        {"FMT", 132}, {"GPA", 5},   {"GPS", 5},   {"IMU", 45},  {"IMU2", 45}, {"MAG", 8},   {"MAG2", 8},  {"MAG3", 8},
        {"MODE", 1},  {"MSG", 6},   {"NKF1", 24}, {"NKF2", 24}, {"NKF3", 24}, {"NKF4", 24}, {"NKF5", 24}, {"NKF6", 24},
        {"NKF7", 24}, {"NKF8", 24}, {"NKF9", 24}, {"NKQ1", 24}, {"NKQ2", 24}, {"NTUN", 23}, {"ORGN", 2},  {"PARM", 809},
        {"PIDP", 24}, {"PIDR", 24}, {"PIDS", 24}, {"PIDY", 24}, {"PM", 1},    {"POS", 23},  {"POWR", 8},  {"RAD", 1},
        {"RCIN", 23}, {"RCOU", 23}, {"RSSI", 23}, {"STAT", 3},  {"STRT", 1},  {"TERR", 1},  {"VIBE", 23}}});
}

TEST(RealDataFlash, ValuesAreThoseOfAnIndependentDecoder) {
  const auto path = shared_flight("ardupilot/test_log_pilot_position.BIN");
  VERIDYN_NEEDS_SHARED(path);
  const Recording recording = to_recording(read_dataflash(read_file(path), path.string()));
  const Channel& up = recording.at("IMU.AccZ");
  EXPECT_NEAR(up.times()[0], 4.046252, 1e-9);
  EXPECT_NEAR(up.value.front(), -9.674799919128418, 1e-12);
  EXPECT_NEAR(up.value.back(), -9.616449356079102, 1e-12);
  double sum = 0.0;
  for (const double value : up.value) sum += value;
  EXPECT_NEAR(sum, -25088.059909820557, 1e-6);
  const Channel& pitch = recording.at("ATT.Pitch");  // stored 490, 480 hundredths of a degree; 566879 in sum
  EXPECT_NEAR(pitch.value.front(), 4.90 * kDegree, 1e-12);
  EXPECT_NEAR(pitch.value.back(), 4.80 * kDegree, 1e-12);
  sum = 0.0;
  for (const double value : pitch.value) sum += value;
  EXPECT_NEAR(sum, 5668.79 * kDegree, 1e-9);
  EXPECT_NEAR(recording.at("GPS.Lat").value.front(), 51.6418311 * kDegree, 1e-12);
  EXPECT_NEAR(recording.at("GPS.Alt").value.front(), 8.46, 1e-9);
  EXPECT_NEAR(recording.at("MAG.MagX").value.front(), -234e-3 * 1e-4, 1e-12);  // milligauss in tesla
  EXPECT_NEAR(recording.at("BARO.Press").value.front(), 101535.71875, 1e-9);
  EXPECT_NEAR(recording.at("XKF1.Yaw").value.back(), 153.82 * kDegree, 1e-12);
}

}  // namespace
}  // namespace veridyn::io
