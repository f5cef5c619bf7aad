#include "veridyn/io/tables/csv_header.hpp"

#include "tests/io/support.hpp"

namespace veridyn::io::internal {
namespace {

using ::testing::HasSubstr;
using testing::message_of;

TEST(CsvHeader, SplitsANameFromItsUnit) {
  const auto parts = [](const char* cell, bool our_own) {
    const Header header = split_header(cell, our_own, "log.csv:1");
    return header.name + "|" + header.unit;
  };
  EXPECT_EQ(parts("speed[km/h]", false), "speed|km/h");
  EXPECT_EQ(parts("speed [km/h]", false), "speed|km/h");
  EXPECT_EQ(parts("speed", false), "speed|");
  EXPECT_EQ(parts("control[3]", false), "control[3]|");
  EXPECT_EQ(parts("mode[armed]", false), "mode[armed]|");
  EXPECT_EQ(parts("control[3][1]", true), "control[3]|1");
  EXPECT_THAT(message_of([] { static_cast<void>(split_header("speed[parsek]", true, "log.csv:1")); }),
              HasSubstr("log.csv:1: column 'speed'"));
}

TEST(CsvHeader, ChoosesWhereTheStampsAre) {
  const auto choose = [](const std::vector<Header>& headers, const CsvOptions& options, const char* row) {
    return choose_time(headers, options, row, ',', "log.csv");
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
  EXPECT_TRUE(choose({{"a", ""}, {"when", ""}}, {}, "1,2024-02-11 23:59:59.9").dates);
  EXPECT_EQ(choose({{"a", ""}}, {.rate = 10.0}, "1").column, TimeChoice::kNone);
}

TEST(CsvHeader, SaysWhatToDoWithoutATimeColumn) {
  EXPECT_THAT(message_of([] {
                static_cast<void>(choose_time({{"a", ""}, {"b", ""}}, {}, "1,2", ',', "log.csv"));
              }),
              HasSubstr("log.csv: no time column found among a, b; name it in the study"));
  EXPECT_THAT(message_of([] {
                static_cast<void>(choose_time({{"time", "m"}}, {.time_column = "time"}, "1", ',', "log.csv"));
              }),
              HasSubstr("column 'time'"));
}

}  // namespace
}  // namespace veridyn::io::internal
