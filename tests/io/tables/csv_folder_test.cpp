#include "veridyn/io/tables/csv_folder.hpp"

#include <fmt/format.h>

#include "tests/io/support.hpp"
#include "veridyn/io/read.hpp"

namespace veridyn::io {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::message_of;

std::string prefix_of(const std::vector<std::filesystem::path>& paths) { return log_prefix(paths); }

TEST(CsvFolder, KnowsTheNameOfALogAheadOfItsTopics) {
  EXPECT_EQ(prefix_of({"flight7_vehicle_attitude_0.csv", "flight7_vehicle_status_0.csv"}), "flight7_");
  EXPECT_EQ(prefix_of({"10_13_09_wind_0.csv", "10_13_09_sensor_combined_0.csv"}), "10_13_09_");
  EXPECT_EQ(prefix_of({"vehicle_attitude_0.csv", "vehicle_status_0.csv"}), "");
  EXPECT_EQ(prefix_of({"run_IMU.csv", "run_GPS.csv"}), "");
  EXPECT_EQ(prefix_of({}), "");
  EXPECT_EQ(table_name("flight7_sensor_baro_1.csv", "flight7_"), "sensor_baro[1]");
  EXPECT_EQ(table_name("IMU.csv"), "IMU");
}

TEST(CsvFolder, ReadsEachTableWithItsOwnStamps) {
  const testing::TemporaryFolder folder;
  (void)folder.write("log_vehicle_attitude_0.csv", "timestamp,q[0]\n1000000,1\n1020000,1\n");
  (void)folder.write("log_sensor_baro_0.csv", "timestamp,pressure\n1000000,1000\n1100000,1001\n1200000,1002\n");
  (void)folder.write("log_parameters.csv", "name,value\nA,1\n");
  const Recording recording = read_recording(folder.path());
  EXPECT_THAT(recording.names(), ElementsAre("sensor_baro.pressure", "vehicle_attitude.q[0]"));
  EXPECT_EQ(recording.at("sensor_baro.pressure").size(), 3U);
  EXPECT_NEAR(recording.at("sensor_baro.pressure").times()[1], 1.1, 1e-12);
  EXPECT_NEAR(recording.at("vehicle_attitude.q[0]").times()[1], 1.02, 1e-12);
  EXPECT_THAT(recording.warnings, Contains(HasSubstr("log_parameters.csv:1: no time column found")));
}

/// Flights of 20 s and 30 s, a row every `step` [s], on a clock that restarts; x numbers the flight.
std::string restarting_flights(double step) {
  std::string text = "timestamp,x\n";
  for (const int flight : {1, 2}) {
    const double end = flight == 1 ? 20.0 : 30.0;
    for (int i = 0; step * i <= end; ++i) text += fmt::format("{},{}\n", 1'000'000 + 1e6 * step * i, flight);
  }
  return text;
}

TEST(CsvFolder, OfSeveralFlightsIsReadPartByPart) {
  const testing::TemporaryFolder folder;
  (void)folder.write("log_vehicle_attitude_0.csv", restarting_flights(0.1));
  (void)folder.write("log_sensor_baro_0.csv", restarting_flights(0.5));
  (void)folder.write("log_sensor_gps_0.csv", "timestamp,x\n1000000,1\n2000000,1\n");
  // In the second flight it stopped early, so that its longest part is the first.
  std::string early = "timestamp,x\n";
  for (int i = 0; i < 100; ++i) early += fmt::format("{},1\n", 1'000'000 + 200'000 * i);
  for (int i = 0; i < 20; ++i) early += fmt::format("{},2\n", 1'000'000 + 200'000 * i);
  (void)folder.write("log_sensor_mag_0.csv", early);
  for (const std::size_t asked : {0U, 1U, 2U}) {
    SCOPED_TRACE(asked);
    ReadOptions options;
    options.csv.part = asked;
    const Log log = read_log(folder.path(), options);
    const double flight = asked == 1 ? 1.0 : 2.0;
    for (const char* name : {"vehicle_attitude", "sensor_baro", "sensor_mag"}) {
      ASSERT_NE(log.find(name), nullptr) << name;
      EXPECT_EQ(log.find(name)->find("x")->value(0), flight) << name << ": all of one flight";
    }
    EXPECT_EQ(log.find("vehicle_attitude")->size(), asked == 1 ? 201U : 301U);
    EXPECT_EQ(log.find("sensor_gps"), nullptr);
    EXPECT_THAT(log.damage.notes,
                Contains(AllOf(HasSubstr("log_sensor_gps_0.csv: its clock does not restart"), HasSubstr("2 parts"))));
    EXPECT_THAT(log.damage.notes, Contains(HasSubstr("vehicle_attitude: the clock restarts: part 1 (rows 1 to 201")));
  }
  ReadOptions third;
  third.csv.part = 3;
  EXPECT_THAT(message_of([&] { (void)read_log(folder.path(), third); }), HasSubstr("has no part 3"));
}

TEST(CsvFolder, WithPausesIsReadPartByPart) {
  const testing::TemporaryFolder folder;
  std::string text = "timestamp,x\n";
  for (const int flight : {1, 2})
    for (int i = 0; i < 100; ++i) text += fmt::format("{},{}\n", 1'000'000 + 100'000 * (i + 2000 * flight), flight);
  (void)folder.write("a.csv", text);
  (void)folder.write("b.csv", text);
  ReadOptions options;
  EXPECT_THAT(read_log(folder.path(), options).damage.notes, Contains(HasSubstr("pauses or restarts part it: part 1")));
  options.csv.part = 2;
  const Log log = read_log(folder.path(), options);
  for (const char* name : {"a", "b"}) {
    EXPECT_EQ(log.find(name)->size(), 100U);
    EXPECT_EQ(log.find(name)->find("x")->value(0), 2.0);
  }
}

TEST(CsvFolder, RefusesAFolderWithoutARecording) {
  const testing::TemporaryFolder folder;
  (void)folder.write("polar.csv", "alpha,CL\n1,2\n");
  EXPECT_THAT(message_of([&] { (void)read_log(folder.path()); }), HasSubstr("holds no table of a recording: "));
}

}  // namespace
}  // namespace veridyn::io
