#include "veridyn/io/log/clock_restarts.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "veridyn/io/dataflash/dataflash.hpp"
#include "veridyn/io/read.hpp"
#include "veridyn/io/ulog/ulog.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::pack;

/// The moments at which a clock with these stamps restarts, after the note of it.
std::vector<double> restarts_of(const std::vector<double>& stamps) {
  ClockRestarts clock;
  for (std::size_t i = 0; i < stamps.size(); ++i) clock.add(stamps[i], 10 * i);
  clock.finish();
  Log log;
  clock.report_to(log);
  return log.restarts;
}

/// Stamps every 0.1 s.
void add_stretch(std::vector<double>& stamps, double begin, double end) {
  for (int i = 0; begin + 0.1 * i <= end; ++i) stamps.push_back(begin + 0.1 * i);
}

TEST(ClockRestarts, AreWhereStampsBeginAgainAndTimesGoOnAMinuteLater) {
  std::vector<double> stamps;
  add_stretch(stamps, 20.0, 100.0);
  const std::size_t first = stamps.size();
  add_stretch(stamps, 5.0, 50.0);
  add_stretch(stamps, 400.0, 420.0);  // a pause of the same clock
  const std::size_t second = stamps.size();
  add_stretch(stamps, 30.0, 32.0);
  ClockRestarts clock;
  for (std::size_t i = 0; i < stamps.size(); ++i) clock.add(stamps[i], 10 * i);
  clock.finish();
  EXPECT_EQ(clock.shift_at(10 * (first - 1)), 0.0);
  EXPECT_NEAR(clock.shift_at(10 * first), 100.0 + 60.0 - 5.0, 1e-9);
  EXPECT_NEAR(clock.shift_at(10 * second - 1), 155.0, 1e-9);
  EXPECT_NEAR(clock.shift_at(10 * second), 155.0 + 420.0 + 60.0 - 30.0, 1e-9);
  Log log;
  clock.report_to(log);
  ASSERT_EQ(log.restarts.size(), 2U);
  EXPECT_NEAR(log.restarts[0], 160.0, 1e-9);
  EXPECT_NEAR(log.restarts[1], 635.0, 1e-9);
  EXPECT_THAT(log.damage.notes, ElementsAre(HasSubstr("its clock restarts 2 times")));
}

TEST(ClockRestarts, AreNotStampsThatAreOffNorMessagesOfAnotherClock) {
  std::vector<double> stamps;
  add_stretch(stamps, 100.0, 200.0);
  std::vector<double> spikes = stamps;
  for (std::size_t i = 50; i < 60; ++i) spikes[i] = 3.0;
  spikes[300] = 1e9;
  spikes[301] = kNaN;
  spikes[302] = -5.0;
  EXPECT_THAT(restarts_of(spikes), IsEmpty());
  std::vector<double> two_clocks;
  for (const double t : stamps) {
    two_clocks.push_back(t);
    two_clocks.push_back(t - 90.0);
  }
  EXPECT_THAT(restarts_of(two_clocks), IsEmpty());
  EXPECT_THAT(restarts_of({}), IsEmpty());
  std::vector<double> hourly;
  for (int day = 0; day < 2; ++day)
    for (int i = 0; i < 24; ++i) hourly.push_back(3600.0 * i);
  EXPECT_THAT(restarts_of(hourly), IsEmpty()) << "stamps that never follow each other are taken for nothing";
}

TEST(ClockRestarts, AtTheBeginningDamagedStampsAreNoClock) {
  std::vector<double> stamps{9e5, 9e5, 9e5};
  add_stretch(stamps, 10.0, 30.0);
  EXPECT_THAT(restarts_of(stamps), IsEmpty());
}

TEST(ClockRestarts, HoldWhatIsLoggedAtPowerOnWithTheFlightAfterIt) {
  std::vector<double> stamps;
  add_stretch(stamps, 20.0, 1000.0);
  const std::size_t first = stamps.size();
  for (int i = 0; i < 5; ++i) stamps.push_back(3.0);  // parameters
  add_stretch(stamps, 90.0, 100.0);
  ClockRestarts clock;
  for (std::size_t i = 0; i < stamps.size(); ++i) clock.add(stamps[i], i);
  EXPECT_NEAR(clock.shift_at(first), 1057.0, 1e-9);
  EXPECT_EQ(clock.shift_at(first - 1), 0.0);
}

/// A log that was written in two flights of 20 s and 10 s: the gyro's x is the number of the flight.
std::string two_dataflash_flights() {
  std::string bytes;
  for (const int flight : {1, 2}) {
    testing::DataFlashWriter log;
    log.format(130, "MSG", "QZ", "TimeUS,Message");
    log.format(131, "IMU", "QBf", "TimeUS,I,GyrX");
    log.format(132, "NOTE", "f", "X");  // without a stamp
    const double begin = flight == 1 ? 40e6 : 12e6;
    log.record("MSG", {begin, std::string("flight ") + std::to_string(flight)});
    for (int i = 0; i <= (flight == 1 ? 200 : 100); ++i) {
      for (const double instance : {0.0, 1.0})
        log.record("IMU", {begin + 1e5 * i, instance, static_cast<double>(flight)});
      if (i == 50) log.record("NOTE", {1.0 * flight});
    }
    bytes += log.take();
  }
  return bytes;
}

std::string two_text_flights() {
  std::string text = "FMT, 131, 31, IMU, If, TimeMS,GyrX\n";
  for (const int flight : {1, 2})
    for (int i = 0; i <= (flight == 1 ? 200 : 100); ++i)
      text += "IMU, " + std::to_string((flight == 1 ? 40000 : 12000) + 100 * i) + ", " + std::to_string(flight) + "\n";
  return text;
}

/// As two logs of PX4, one after the other.
std::string two_ulog_flights() {
  std::string bytes;
  for (const int flight : {1, 2}) {
    testing::ULogWriter log;
    log.format("sensor_gyro:uint64_t timestamp;float x;");
    log.parameter("FLIGHT", flight);
    // In the second log the identifiers are others.
    const auto id = static_cast<std::uint16_t>(flight + 4);
    log.subscribe(id, "sensor_gyro");
    const std::uint64_t begin = flight == 1 ? 40'000'000 : 12'000'000;
    log.text('6', begin + 1'000'000, "flight " + std::to_string(flight));
    for (std::uint64_t i = 0; i <= (flight == 1 ? 200U : 100U); ++i)
      log.data(id, pack(begin + 100'000 * i, static_cast<float>(flight)));
    bytes += log.bytes();
  }
  return bytes;
}

struct Written {
  const char* file;
  std::string bytes;
  const char* topic;
  const char* field;
};

std::array<Written, 3> two_flights_of_each_format() {
  return {{{"two.bin", two_dataflash_flights(), "IMU", "GyrX"},
           {"two.log", two_text_flights(), "IMU", "GyrX"},
           {"two.ulg", two_ulog_flights(), "sensor_gyro", "x"}}};
}

TEST(ClockRestarts, PartLogsOfEveryAutopilotAndEachPartIsReadByItsNumber) {
  const testing::TemporaryFolder folder;
  for (const Written& written : two_flights_of_each_format()) {
    SCOPED_TRACE(written.file);
    const auto path = folder.write(written.file, written.bytes);
    const Log all = read_log(path);
    EXPECT_EQ(all.damage.bytes_lost, 0U);
    EXPECT_EQ(all.find(written.topic)->size(), 302U);
    EXPECT_EQ(all.find(written.topic)->reordered, 0U) << "flights are not sorted into one another";
    EXPECT_THAT(all.damage.notes, Contains(HasSubstr("its clock restarts 1 time: times go on 60 s after")));
    EXPECT_THAT(all.damage.notes, Contains(HasSubstr("part 1 (40.0 s to 60.0 s), part 2 (120.0 s to 130.0 s)")));
    for (const std::size_t part : {1U, 2U}) {
      ReadOptions options;
      options.csv.part = part;
      const Log one = read_log(path, options);
      const LogTopic& topic = *one.find(written.topic);
      EXPECT_EQ(topic.size(), part == 1 ? 201U : 101U);
      for (std::size_t i = 0; i < topic.size(); ++i)
        ASSERT_EQ(topic.find(written.field)->value(i), static_cast<double>(part));
    }
  }
}

TEST(ClockRestarts, MoveEventsAndMessagesWithoutStampsWithTheirFlight) {
  const Log px4 = read_ulog(two_ulog_flights(), "two.ulg");
  ASSERT_EQ(px4.events.size(), 2U);
  EXPECT_NEAR(px4.events[0].time, 41.0, 1e-9);
  EXPECT_NEAR(px4.events[1].time, 121.0, 1e-9);
  EXPECT_EQ(px4.topics.size(), 1U) << "one topic, though it was subscribed to twice";
  EXPECT_EQ(px4.parameters.at("FLIGHT"), 2.0);
  const Log ardupilot = read_dataflash(two_dataflash_flights(), "two.bin");
  ASSERT_EQ(ardupilot.events.size(), 2U);
  EXPECT_NEAR(ardupilot.events[1].time, 120.0, 1e-9);
  const LogTopic& note = *ardupilot.find("NOTE");
  ASSERT_EQ(note.size(), 2U);
  EXPECT_NEAR((*note.time)[0], 45.0, 1e-9);
  EXPECT_NEAR((*note.time)[1], 125.0, 1e-9);
  EXPECT_EQ(note.find("X")->value(1), 2.0);
  EXPECT_EQ(ardupilot.find("IMU", 1)->size(), 302U);
}

TEST(ClockRestarts, OfLogsWhoseFormatsDifferLeaveTwoTopics) {
  std::string bytes;
  for (const bool second : {false, true}) {
    testing::ULogWriter log;
    log.format(second ? "a:uint64_t timestamp;float y;float x;" : "a:uint64_t timestamp;float x;");
    log.subscribe(0, "a");
    for (std::uint64_t i = 0; i < 60; ++i)
      log.data(0, second ? pack(1'000'000 + 100'000 * i, 5.0F, 2.0F) : pack(90'000'000 + 100'000 * i, 1.0F));
    bytes += log.bytes();
  }
  const Log log = read_ulog(bytes, "two.ulg");
  ASSERT_EQ(log.topics.size(), 2U);
  EXPECT_EQ(log.topics[0].find("x")->value(59), 1.0);
  EXPECT_EQ(log.topics[1].find("x")->value(0), 2.0) << "each log by its own formats";
  EXPECT_NEAR(log.topics[1].time->front(), 95.9 + 60.0, 1e-9);
}

TEST(ClockRestarts, AreInNoRecordedFlight) {
  const std::filesystem::path recordings = testing::shared_flight("");
  VERIDYN_NEEDS_SHARED(recordings);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(recordings)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".bin" && extension != ".BIN" && extension != ".ulg" && extension != ".log") continue;
    ++files;
    EXPECT_THAT(read_log(entry.path()).restarts, IsEmpty()) << entry.path();
  }
  EXPECT_GE(files, 6U);
}

}  // namespace
}  // namespace veridyn::io
