#include "veridyn/io/ulog/ulog.hpp"

#include <map>
#include <numbers>

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/ulog/px4_units.hpp"
#include "veridyn/io/ulog/ulog_format.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::message_of;
using testing::pack;
using testing::shared_flight;
using testing::ULogWriter;

Log read_small_log() { return read_ulog(testing::small_ulog(), "small.ulg"); }

TEST(ULog, ReadsArraysNestedMessagesTextsAndLeavesPaddingOut) {
  const Log log = read_small_log();
  const LogTopic& escs = *log.find("esc_status");
  ASSERT_EQ(escs.size(), 6U);
  EXPECT_DOUBLE_EQ(escs.find("esc[0].esc_rpm")->value(5), 5005.0);
  EXPECT_DOUBLE_EQ(escs.find("esc[1].esc_rpm")->value(0), -7.0);
  EXPECT_DOUBLE_EQ(escs.find("armed")->value(0), 1.0);
  EXPECT_EQ(escs.find("label")->values.text(0), "ab");
  for (const LogField& field : escs.fields) EXPECT_THAT(field.name, ::testing::Not(HasSubstr("padding")));
  const Recording recording = to_recording(log);
  EXPECT_DOUBLE_EQ(recording.at("sensor_combined.gyro_rad[0]").value[3], 1.5);
  EXPECT_EQ(recording.at("sensor_combined.gyro_rad[0]").unit.name, "rad/s");
  EXPECT_NEAR(recording.at("sensor_combined.gyro_rad[2]").times()[5], 1.020, 1e-12);
  EXPECT_NEAR(recording.at("esc_status.esc[1].esc_rpm").value[0], -7.0 * 2.0 * std::numbers::pi / 60.0, 1e-12);
}

TEST(ULog, ReadsFormatsThatStandAfterTheirDataAndNumbersInstances) {
  const Recording recording = to_recording(read_small_log());
  // -1000 degC, a sentinel of a sensor that is not there, is left to those who know: 1000 below is no temperature.
  EXPECT_NEAR(recording.at("differential_pressure[1].temperature").value[0], -1000.0 + 273.15, 1e-3);
}

TEST(ULog, ReadsInformationParametersTextsAndDropouts) {
  const Log log = read_small_log();
  EXPECT_EQ(log.information.at("sys_name"), "PX4");
  EXPECT_EQ(log.information.at("ver_sw_release"), "17498624");
  EXPECT_EQ(log.information.at("notes"), "one\ntwo!!");
  EXPECT_DOUBLE_EQ(log.parameters.at("FW_AIRSPD_MIN"), 11.0);
  EXPECT_DOUBLE_EQ(log.parameters.at("SYS_AUTOSTART"), 2106.0);
  EXPECT_DOUBLE_EQ(log.default_parameters.at("FW_AIRSPD_MIN"), 10.0);
  EXPECT_EQ(log.damage.dropouts, 1U);
  EXPECT_NEAR(log.damage.dropout_s, 0.030, 1e-12);
  EXPECT_EQ(log.damage.bytes_lost, 0U);
  std::vector<std::string> events;
  for (const Event& event : log.events) events.push_back(event.kind + ": " + event.text);
  EXPECT_THAT(events, ::testing::UnorderedElementsAre("message: [logger] started", "message: tagged words",
                                                      "parameter: FW_AIRSPD_MIN = 11", "mode: MANUAL",
                                                      "armed: disarmed", "mode: AUTO_MISSION", "armed: armed"));
}

TEST(ULog, RefusesIncompatibleFlagsThatItDoesNotKnow) {
  ULogWriter log;
  log.bytes()[16 + 3 + 8 + 1] = 2;  // bit 9
  EXPECT_EQ(message_of([&] { (void)read_ulog(log.bytes(), "new.ulg"); }),
            "new.ulg: this ULog needs features that this reader does not know (incompatible flag bits 0x200)");
}

TEST(ULog, GoesOnAtAppendedDataThoughTheMessageBeforeIsCut) {
  ULogWriter log;
  log.format("a:uint64_t timestamp;float x;");
  log.subscribe(0, "a");
  log.data(0, pack(std::uint64_t{1000000}, 1.0F));
  log.raw(
      std::string_view("\x40\x00"
                       "D\x00\x00half of",
                       12));  // says 64 bytes, has nine
  log.append_from_here(0);
  log.data(0, pack(std::uint64_t{2000000}, 2.0F));
  log.append_from_here(1);
  log.data(0, pack(std::uint64_t{3000000}, 3.0F));
  const Log result = read_ulog(log.bytes(), "crash.ulg");
  EXPECT_EQ(result.find("a")->size(), 3U);
  EXPECT_EQ(result.damage.bytes_lost, 12U);
  EXPECT_EQ(result.damage.records_lost, 1U);
}

TEST(ULog, CountsDataThatAreTooShortOrWithoutASubscription) {
  ULogWriter log;
  log.format("a:uint64_t timestamp;float x;");
  log.subscribe(0, "a");
  for (int i = 0; i < 5; ++i) log.data(0, pack(static_cast<std::uint64_t>(1000 * i), 1.0F));
  log.data(0, pack(std::uint64_t{4000}));  // four bytes are missing
  log.data(9, pack(std::uint64_t{4000}, 1.0F));
  log.data(0, pack(std::uint64_t{5000}, 1.0F, 77.0F));  // more than the format: cut
  const Log result = read_ulog(log.bytes(), "a.ulg");
  EXPECT_EQ(result.find("a")->size(), 6U);
  EXPECT_EQ(result.damage.records_lost, 2U);
  EXPECT_THAT(result.damage.notes, Contains(HasSubstr("1 messages of a are shorter than their format (12 bytes)")));
  EXPECT_THAT(result.damage.notes, Contains(HasSubstr("1 data messages of ids without a subscription")));
}

TEST(ULog, ResynchronisesAfterRubbishAndCountsIt) {
  ULogWriter log;
  log.format("a:uint64_t timestamp;float x;");
  log.subscribe(0, "a");
  for (int i = 0; i < 10; ++i) log.data(0, pack(static_cast<std::uint64_t>(1000 * i), 1.0F));
  log.raw(std::string(300, '\xEE'));
  for (int i = 10; i < 20; ++i) log.data(0, pack(static_cast<std::uint64_t>(1000 * i), 1.0F));
  const Log result = read_ulog(log.bytes(), "a.ulg");
  EXPECT_EQ(result.find("a")->size(), 20U);
  EXPECT_EQ(result.damage.bytes_lost, 300U);
  EXPECT_EQ(result.damage.records_lost, 1U);
}

TEST(ULog, RefusesFormatsThatContainThemselvesOrGrowWithoutEnd) {
  EXPECT_FALSE(resolve_ulog_format({{"a", "b x;"}, {"b", "a y;"}}, "a"));
  EXPECT_FALSE(resolve_ulog_format({{"a", "float[70000] x;"}}, "a"));
  EXPECT_FALSE(resolve_ulog_format({{"a", "float[3 x;"}}, "a"));
  EXPECT_FALSE(resolve_ulog_format({{"a", "nothing x;"}}, "a"));
  ULogFormats bomb{{"z", "uint8_t _padding0;"}};
  std::string last = "z";
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) {
    bomb[name] = last + "[60000] x;";
    last = name;
  }
  EXPECT_FALSE(resolve_ulog_format(bomb, "f"));
}

TEST(ULog, SaysWhatIsWrongWithAFileThatIsNone) {
  EXPECT_EQ(message_of([] { (void)read_ulog("", "a.ulg"); }), "a.ulg: the file is empty");
  EXPECT_EQ(message_of([] { (void)read_ulog("time,x\n", "a.ulg"); }),
            "a.ulg: not a PX4 ULog: it does not start with 55 4C 6F 67 01 12 35");
  EXPECT_EQ(message_of([] { (void)read_ulog(testing::small_ulog().substr(0, 9), "a.ulg"); }),
            "a.ulg: the ULog ends inside its header (9 of 16 bytes)");
}

TEST(Px4Units, KnowsFieldsByTopicAndBySuffix) {
  EXPECT_EQ(px4_unit("vehicle_gps_position", "lat").scale, 1e-7);
  EXPECT_EQ(px4_unit("airspeed", "true_airspeed_m_s").unit, "m/s");
  EXPECT_EQ(px4_unit("sensor_combined", "accelerometer_m_s2").unit, "m/s^2");
  EXPECT_EQ(px4_unit("anything", "drift_rad_s").unit, "rad/s");
  EXPECT_EQ(px4_unit("anything", "counter").unit, "1");
}

// Numbers from an independent decoder: 15 lines of Python with struct.unpack that walk the messages and count.
TEST(RealULog, EveryMessageOfAVtolLogIsDecoded) {
  const auto path = shared_flight("px4/sample_log_small.ulg");
  VERIDYN_NEEDS_SHARED(path);
  const Log log = read_ulog(read_file(path), path.string());
  EXPECT_EQ(log.damage.bytes_lost, 0U);
  EXPECT_EQ(log.damage.records_lost, 0U);
  EXPECT_EQ(log.damage.dropouts, 1U);
  EXPECT_NEAR(log.damage.dropout_s, 0.030, 1e-12);
  EXPECT_EQ(log.parameters.size(), 980U);
  EXPECT_EQ(log.topics.size(), 70U);
  std::size_t rows = 0;
  for (const LogTopic& topic : log.topics) rows += topic.size() + topic.spikes;
  EXPECT_EQ(rows, 14604U);
  const std::map<std::pair<std::string, int>, std::size_t> some{{{"actuator_controls_1", 0}, 1812},
                                                                {{"actuator_outputs", 1}, 65},
                                                                {{"airspeed", 0}, 595},
                                                                {{"battery_status", 1}, 21},
                                                                {{"sensor_combined", 0}, 1298},
                                                                {{"sensor_mag", 1}, 6},
                                                                {{"vehicle_attitude", 0}, 1298},
                                                                {{"vehicle_imu_status", 1}, 7},
                                                                {{"wind_estimate", 1}, 8},
                                                                {{"vehicle_angular_velocity", 0}, 1812},
                                                                {{"differential_pressure", 1}, 6}};
  for (const auto& [key, count] : some) {
    const LogTopic* topic = log.find(key.first, key.second);
    ASSERT_NE(topic, nullptr) << key.first;
    EXPECT_EQ(topic->size(), count) << key.first;
  }
  const Recording recording = to_recording(log);
  const Channel& roll_rate = recording.at("sensor_combined.gyro_rad[0]");
  EXPECT_NEAR(roll_rate.times().front(), 20.326716, 1e-9);
  EXPECT_NEAR(roll_rate.times().back(), 26.822868, 1e-9);
  EXPECT_NEAR(roll_rate.value.front(), 0.002968383487313986, 1e-15);
  double sum = 0.0;
  for (const double value : roll_rate.value) sum += value;
  EXPECT_NEAR(sum, 5.7863019622338925, 1e-9);
  EXPECT_NEAR(recording.at("vehicle_attitude.q[0]").value.front(), 0.9926282167434692, 1e-12);
  EXPECT_NEAR(recording.at("airspeed.indicated_airspeed_m_s").value.front(), -2.361255407333374, 1e-12);
  EXPECT_NEAR(recording.at("airspeed.air_temperature_celsius").value.front(), 23.22432518005371 + 273.15, 1e-9);
}

TEST(RealULog, AppendedDataOfACrashedLoggerAreRead) {
  const auto path = shared_flight("px4/sample_appended_multiple.ulg");
  VERIDYN_NEEDS_SHARED(path);
  const Log log = read_ulog(read_file(path), path.string());
  EXPECT_EQ(log.damage.bytes_lost, 0U);
  EXPECT_EQ(log.parameters.size(), 750U);
  std::size_t rows = 0;
  for (const LogTopic& topic : log.topics) rows += topic.size() + topic.spikes;
  EXPECT_EQ(rows, 6852U);
  EXPECT_EQ(log.find("sensor_combined")->size(), 2373U);
  EXPECT_EQ(log.find("vehicle_attitude")->size(), 306U);
  EXPECT_EQ(log.find("actuator_outputs", 1)->size(), 96U);
  const Channel rate = to_recording(log).at("sensor_combined.gyro_rad[0]");
  double sum = 0.0;
  for (const double value : rate.value) sum += value;
  EXPECT_NEAR(sum, -9.165098065610437, 1e-9);
}

}  // namespace
}  // namespace veridyn::io
