#include "veridyn/io/log/log_parts.hpp"

#include <fmt/format.h>

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "tests/support/tlog_writer.hpp"
#include "veridyn/io/read.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::message_of;
using ::testing::Not;
using testing::pack;

/// A topic with a row every `step` over each of some stretches.
LogTopic topic(const char* name, double step, const std::vector<TimeSpan>& stretches) {
  LogTopic out;
  out.name = name;
  std::vector<double> stamps;
  for (const TimeSpan& s : stretches)
    for (double t = s.begin; t < s.end + 1e-9; t += step) stamps.push_back(t);
  TextColumn texts;
  for (const double t : stamps) texts.push_back(std::to_string(t));
  out.fields.push_back({.name = "x", .values = Column(stamps)});
  out.fields.push_back({.name = "text", .values = Column(std::move(texts))});
  out.time = make_time_base(std::move(stamps));
  return out;
}

Log two_flights() {
  Log log;
  log.source = "two.bin";
  log.topics.push_back(topic("IMU", 0.1, {{0.0, 20.0}, {100.0, 150.0}}));
  log.topics.push_back(topic("GPS", 1.0, {{1.0, 21.0}, {98.0, 150.0}}));
  log.events = {{5.0, "mode", "AUTO"}, {120.0, "mode", "MANUAL"}};
  return log;
}

TEST(LogParts, AreBetweenPausesOfAllTopics) {
  const std::vector<TimeSpan> parts = log_parts(two_flights());
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].begin, 0.0);
  EXPECT_NEAR(parts[0].end, 21.0, 1e-9);
  EXPECT_NEAR(parts[1].begin, 98.0, 1e-9);
  Log bridged = two_flights();
  bridged.topics.push_back(topic("BAT", 10.0, {{0.0, 150.0}}));
  EXPECT_EQ(log_parts(bridged).size(), 1U) << "something was logged in between";
  Log slow;
  slow.topics.push_back(topic("hourly", 3600.0, {{0.0, 86400.0}}));
  EXPECT_EQ(log_parts(slow).size(), 1U) << "rows an hour apart are no pause";
  EXPECT_TRUE(log_parts(Log()).empty());
}

TEST(LogParts, AreListedAndOneIsLeftOnRequest) {
  Log all = two_flights();
  choose_part(all, 0);
  EXPECT_EQ(all.topics[0].size(), 201U + 501U);
  EXPECT_THAT(all.damage.notes,
              Contains(HasSubstr("part 1 (0.0 s to 21.0 s), part 2 (98.0 s to 150.0 s); all are read")));
  Log second = two_flights();
  choose_part(second, 2);
  EXPECT_EQ(second.part, 2U);
  ASSERT_EQ(second.topics[0].size(), 501U);
  EXPECT_NEAR(second.topics[0].time->front(), 100.0, 1e-9);
  EXPECT_NEAR(second.topics[0].fields[0].value(0), 100.0, 1e-9);
  EXPECT_EQ(second.topics[0].fields[1].values.text(0), std::to_string(100.0));
  EXPECT_EQ(second.topics[1].size(), 53U);
  ASSERT_EQ(second.events.size(), 1U);
  EXPECT_EQ(second.events[0].text, "MANUAL");
  EXPECT_EQ(message_of([] {
              Log log = two_flights();
              choose_part(log, 3);
            }),
            "two.bin: has no part 3: it has part 1 (0.0 s to 21.0 s), part 2 (98.0 s to 150.0 s)");
}

TEST(LogParts, OfTelemetryAreItsRestartsTooAndTheyAreReadByTheirNumber) {
  testing::TlogWriter writer;
  const auto attitude = [&](std::uint64_t us, std::uint32_t boot_ms, float roll) {
    writer.packet(us, 30, 39, pack(boot_ms, roll, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F));
  };
  for (std::uint32_t i = 0; i < 100; ++i) attitude(100'000ULL * i, 500'000 + 100 * i, 1.0F);
  // Five seconds later the autopilot has restarted.
  for (std::uint32_t i = 0; i < 80; ++i) attitude(15'000'000 + 100'000ULL * i, 3000 + 100 * i, 2.0F);
  const testing::TemporaryFolder folder;
  const auto path = folder.write("two.tlog", writer.bytes());
  EXPECT_THAT(read_log(path).damage.notes, Contains(HasSubstr("part 1 (0.0 s to 15.0 s), part 2 (15.0 s to 22.9 s)")));
  ReadOptions options;
  options.csv.part = 1;
  const Log first = read_log(path, options);
  EXPECT_EQ(first.find("ATTITUDE")->size(), 100U) << "the restart itself is of what comes after it";
  options.csv.part = 2;
  const Log second = read_log(path, options);
  ASSERT_EQ(second.find("ATTITUDE")->size(), 80U);
  EXPECT_DOUBLE_EQ(second.find("ATTITUDE")->find("roll")->value(0), 2.0);
}

TEST(LogParts, OfATableWhoseClockRestartsAreThoseOfItsClock) {
  const testing::TemporaryFolder folder;
  std::string text = "time,x\n";
  for (int part = 0; part < 2; ++part)
    for (int i = 0; i < 20; ++i) text += fmt::format("{},{}\n", i + (i >= 12 ? 100 : 0), part);
  ReadOptions options;
  options.csv.time_unit = "s";
  options.csv.part = 2;
  const Log log = read_log(folder.write("restart.csv", text), options);
  EXPECT_EQ(log.topics[0].size(), 20U) << "its pause does not part it once more";
  EXPECT_EQ(log.topics[0].find("x")->value(0), 1.0);
  options.csv.part = 2;
  EXPECT_THAT(message_of([&] { (void)read_log(folder.write("one.csv", "time[s],x\n0,1\n1,1\n"), options); }),
              HasSubstr("has no part 2: nothing parts it"));
}

}  // namespace
}  // namespace veridyn::io
