#include "veridyn/io/tables/time_column.hpp"

#include "tests/io/support.hpp"
#include "veridyn/io/tables/csv_cells.hpp"

namespace veridyn::io::internal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::message_of;

TEST(TimeColumn, ChoosesWhereTheStampsAre) {
  const auto choose = [](const std::vector<Header>& headers, const TableOptions& options, const char* row) {
    return choose_time(headers, options, row, {}, "log.csv");
  };
  const TimeChoice named = choose({{"a", ""}, {"T", ""}}, {.time_column = "T", .time_unit = "ms"}, "1,2");
  EXPECT_EQ(named.column, 1u);
  EXPECT_DOUBLE_EQ(named.scale, 1e-3);
  const TimeChoice headed = choose({{"a", ""}, {"time", "us"}}, {}, "1,2");
  EXPECT_EQ(headed.column, 1u);
  EXPECT_DOUBLE_EQ(headed.scale, 1e-6);
  // A `timestamp` without a unit is in microseconds, unless its numbers have a point.
  EXPECT_DOUBLE_EQ(choose({{"timestamp", ""}}, {}, "1200000").scale, 1e-6);
  EXPECT_DOUBLE_EQ(choose({{"timestamp", ""}}, {}, "1.2").scale, 1.0);
  EXPECT_TRUE(choose({{"a", ""}, {"when", ""}}, {}, "1,2024-02-11 23:59:59.9").texts);
  EXPECT_EQ(choose({{"a", ""}}, {.rate = 10.0}, "1").column, TimeChoice::kNone);
}

TEST(TimeColumn, SaysWhatToDoWithoutATimeColumn) {
  EXPECT_THAT(message_of([] {
                static_cast<void>(choose_time({{"a", ""}, {"b", ""}}, {}, "1,2", {}, "log.csv"));
              }),
              HasSubstr("log.csv: no time column found among a, b; name it in the study"));
  EXPECT_THAT(message_of([] {
                static_cast<void>(choose_time({{"time", "m"}}, {.time_column = "time"}, "1", {}, "log.csv"));
              }),
              HasSubstr("column 'time'"));
}

AssumedUnit assumed(std::string_view name, const std::vector<double>& stamps) {
  return assume_time_unit(name, stamps, "log.csv:1");
}

TEST(TimeColumn, TakesTheUnitInWhichRowsAreAsFarApartAsInARecording) {
  EXPECT_EQ(assumed("time", {0.0, 0.02, 0.04}).unit, "s");
  EXPECT_THAT(assumed("time", {0.0, 0.02, 0.04}).note, IsEmpty());
  EXPECT_EQ(assumed("time", {0.0, 1.0, 2.0}).unit, "s");
  const AssumedUnit ms = assumed("time", {100.0, 120.0, 140.0});
  EXPECT_EQ(ms.unit, "ms");
  EXPECT_EQ(
      ms.note,
      "the stamps of 'time' are taken as ms: whole numbers 20 apart, which gives 50 rows per second; say otherwise "
      "with time = { unit = \"...\" } in [data]");
  EXPECT_EQ(assumed("t", {0.0, 4000.0, 8000.0}).unit, "us");
  EXPECT_EQ(assumed("t", {0.0, 10e6, 20e6}).unit, "ns");
  // With decimals they are seconds, however far apart, and that is said.
  EXPECT_EQ(assumed("t", {0.5, 20.6, 40.2}).unit, "s");
  EXPECT_THAT(assumed("t", {0.5, 20.6, 40.2}).note, HasSubstr("rows then are"));
  // PX4's timestamps are microseconds, however rarely a topic is written.
  EXPECT_EQ(assumed("timestamp", {0.0, 5e6, 10e6}).unit, "us");
  EXPECT_THAT(assumed("timestamp", {0.0, 5e6, 10e6}).note, IsEmpty());
  EXPECT_EQ(assumed("timestamp", {0.0, 20.0, 40.0}).unit, "ms");
}

TEST(TimeColumn, KnowsAUnixClockByTheSizeOfItsNumbers) {
  EXPECT_EQ(assumed("timestamp", {1.7e18, 1.7e18 + 1e7}).unit, "ns");
  EXPECT_EQ(assumed("time", {1.7e15, 1.7e15 + 1e6}).unit, "us");
  EXPECT_EQ(assumed("time", {1.7e12, 1.7e12 + 1e3}).unit, "ms");
  EXPECT_THAT(assumed("time", {1.7e12, 1.7e12 + 1e3}).note, HasSubstr("Unix clock"));
}

TEST(TimeColumn, DoesNotChooseBetweenTwoUnitsThatFit) {
  EXPECT_EQ(message_of([] {
              static_cast<void>(assumed("time", {0.0, 1000.0, 2000.0}));
            }),
            "log.csv:1: the stamps of 'time' are 1000 apart: 1 Hz in ms, or 1e+03 Hz in us? Say which: time = { unit = "
            "\"ms\" } in [data]");
  EXPECT_THAT(message_of([] { static_cast<void>(assumed("time", {0.0, 1e6, 2e6})); }), HasSubstr("in us, or"));
}

TEST(TimeColumn, ReadsTextsThatAreStamps) {
  EXPECT_EQ(parse_text_stamp("2024-05-03 12:00:00")->kind, TextStamp::Kind::kDate);
  EXPECT_EQ(parse_text_stamp("12:00:01.5")->kind, TextStamp::Kind::kTimeOfDay);
  EXPECT_DOUBLE_EQ(parse_text_stamp("12:00:01.5")->second, 43201.5);
  EXPECT_EQ(parse_text_stamp("1.5 min")->kind, TextStamp::Kind::kDuration);
  EXPECT_DOUBLE_EQ(parse_text_stamp("1.5 min")->second, 90.0);
  for (const char* text : {"", "1.5", "12:00", "1.5 m", "24:00:00", "min", "inf s"})
    EXPECT_FALSE(parse_text_stamp(text)) << text;
}

}  // namespace
}  // namespace veridyn::io::internal
