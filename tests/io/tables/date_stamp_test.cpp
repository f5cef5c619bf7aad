#include "veridyn/io/tables/date_stamp.hpp"

#include <gtest/gtest.h>

#include <string>

namespace veridyn::io {
namespace {

TEST(DateStamp, ReadsTheWaysInWhichLoggersWriteIt) {
  // 2016-09-12 11:12:06.642 UTC is 1473678726.642 s of Unix time (date -u -d ... +%s).
  constexpr std::int64_t kDay = 17056;
  constexpr double kSecond = 40326.642;
  static_assert(kDay * 86400 + 40326 == 1473678726);
  for (const char* text : {"2016-09-12 11:12:06.642", "2016-09-12T11:12:06.642Z", "2016/09/12 11:12:06,642",
                           "2016_09_12_11_12_06_642", "2016-9-12 11:12:6.642", "2016.09.12 11:12:06.642000"}) {
    const auto stamp = parse_date_stamp(text);
    ASSERT_TRUE(stamp) << text;
    EXPECT_EQ(stamp->day, kDay) << text;
    EXPECT_NEAR(stamp->second, kSecond, 1e-9) << text;
  }
  EXPECT_DOUBLE_EQ(parse_date_stamp("1970-01-01 00:00:01")->second, 1.0);
  EXPECT_EQ(parse_date_stamp("1969-12-31 00:00:00")->day, -1);
  EXPECT_EQ(parse_date_stamp("2024-02-29 23:59:60")->day, 19782);
  // Whole milliseconds, padded or not.
  EXPECT_NEAR(parse_date_stamp("2024_02_11_01_04_22_43")->second, 3862.043, 1e-9);
  EXPECT_EQ(date_text(19782), "2024-02-29");
}

TEST(DateStamp, CountsZonesInUtc) {
  for (const char* text : {"2016-09-12T13:12:06.642+02:00", "2016-09-12 05:42:06.642-0530",
                           "2016-09-12 12:12:06.642+01", "2016-09-12 11:12:06.642 UTC"}) {
    const auto stamp = parse_date_stamp(text);
    ASSERT_TRUE(stamp) << text;
    EXPECT_EQ(stamp->day, 17056) << text;
    EXPECT_NEAR(stamp->second, 40326.642, 1e-9) << text;
    EXPECT_TRUE(stamp->utc) << text;
  }
  EXPECT_EQ(parse_date_stamp("2016-09-12T00:30:00+01:00")->day, 17055);
  EXPECT_DOUBLE_EQ(parse_date_stamp("2016-09-12T00:30:00+01:00")->second, 84600.0);
  EXPECT_EQ(parse_date_stamp("2016-09-12T23:30:00-01:00")->day, 17057);
  EXPECT_FALSE(parse_date_stamp("2016-09-12T11:12:06")->utc);
  for (const char* text :
       {"2016-09-12T11:12:06+2", "2016-09-12T11:12:06+02:", "2016-09-12T11:12:06+15:00", "2016-09-12T11:12:06 CEST"})
    EXPECT_FALSE(parse_date_stamp(text)) << text;
}

TEST(DateStamp, TakesTheDayFirstWhereItCannotBeTheMonth) {
  for (const char* text : {"12.09.2016 11:12:06", "12-Sep-2016 11:12:06"}) {
    const auto stamp = parse_date_stamp(text);
    ASSERT_TRUE(stamp) << text;
    EXPECT_EQ(stamp->day, 17056) << text;
  }
  EXPECT_FALSE(parse_date_stamp("12/09/2016 11:12:06"));
}

TEST(DateStamp, ReadsTimesOfDay) {
  EXPECT_DOUBLE_EQ(parse_time_of_day("01:02:03.5").value(), 3723.5);
  EXPECT_DOUBLE_EQ(parse_time_of_day("1:02:03,25").value(), 3723.25);
  for (const char* text : {"", "01:02", "25:00:00", "01:02:03 pm", "1:2:3x"})
    EXPECT_FALSE(parse_time_of_day(text)) << text;
}

TEST(DateStamp, RefusesWhatIsNoDate) {
  for (const char* text : {"", "2016", "2016-09-12", "2016-09-12 11:12", "2016-13-12 11:12:06", "2023-02-29 11:12:06",
                           "2016-09-12 24:12:06", "2016-09-12 11:60:06", "2016-09-12 11:12:06.",
                           "2016-09-12 11:12:06 pm", "12-09-2016 11:12:06", "2016-09/12 11:12:06",
                           "2016-09-12 11:12_06", "x2016-09-12 11:12:06", "20160912 111206", "2016-09-12 11:12:61"}) {
    EXPECT_FALSE(parse_date_stamp(text)) << text;
  }
  const std::string whole = "2024_02_11_01_04_22_354";
  for (std::size_t size = 0; size < 18; ++size) EXPECT_FALSE(parse_date_stamp(whole.substr(0, size))) << size;
}

}  // namespace
}  // namespace veridyn::io
