#include "veridyn/io/tables/csv_header.hpp"

#include "tests/io/support.hpp"

namespace veridyn::io::internal {
namespace {

using ::testing::ElementsAre;
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

TEST(CsvHeader, TakesUnitsAsPeopleWriteThem) {
  const auto parts = [](const char* cell) {
    const Header header = split_header(cell, false, "log.csv:1");
    return header.name + "|" + header.unit;
  };
  EXPECT_EQ(parts("p (deg/s)"), "p|deg/s");
  EXPECT_EQ(parts("Speed(km/h)"), "Speed|km/h");
  EXPECT_EQ(parts("Pitch [\xC2\xB0]"), "Pitch|deg");
  EXPECT_EQ(parts("V(2)"), "V(2)|");
  EXPECT_EQ(parts("speed (filtered)"), "speed (filtered)|");
  // In a file of ours parentheses are part of the name.
  EXPECT_EQ(split_header("q (deg/s)[rad/s]", true, "").name, "q (deg/s)");
}

TEST(CsvHeader, BlanksSeparateNamesButNotAUnitFromItsName) {
  EXPECT_THAT(blank_separated("  Time (s)  p [deg / s]\tV"), ElementsAre("Time (s)", "p [deg / s]", "V"));
}

TEST(CsvHeader, KnowsARowOfUnits) {
  EXPECT_THAT(row_of_units({"s", "deg/s", "", "-", "[km/h]"}), ElementsAre("s", "deg/s", "", "", "km/h"));
  EXPECT_TRUE(row_of_units({"0", "1"}).empty());
  EXPECT_TRUE(row_of_units({"", "-"}).empty());
  EXPECT_TRUE(row_of_units({"s", "fast"}).empty());
}

TEST(CsvHeader, KnowsARowOfUnitsAmongOtherWords) {
  EXPECT_THAT(row_of_units_and_words({"hh:mm:ss", "deg", "G", "enum", "-"}), ElementsAre("", "deg", "G", "", ""));
  EXPECT_TRUE(row_of_units_and_words({"time", "V", "p"}).empty());
  EXPECT_TRUE(row_of_units_and_words({"s", "m", "1"}).empty());
}

TEST(CsvHeader, NumbersNamesThatAppearAgain) {
  std::vector<Header> headers{{"V", ""}, {"V(2)", ""}, {"V", ""}, {"V", ""}};
  EXPECT_THAT(number_repeated(headers), ElementsAre("V(3)", "V(4)"));
  EXPECT_EQ(headers[0].name, "V");
  EXPECT_EQ(headers[2].name, "V(3)");
}

}  // namespace
}  // namespace veridyn::io::internal
