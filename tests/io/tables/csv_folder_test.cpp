#include "veridyn/io/tables/csv_folder.hpp"

#include "tests/io/support.hpp"
#include "veridyn/io/read.hpp"

namespace veridyn::io {
namespace {

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

TEST(CsvFolder, RefusesAFolderWithoutARecording) {
  const testing::TemporaryFolder folder;
  (void)folder.write("polar.csv", "alpha,CL\n1,2\n");
  EXPECT_THAT(message_of([&] { (void)read_log(folder.path()); }), HasSubstr("holds no table of a recording: "));
}

}  // namespace
}  // namespace veridyn::io
