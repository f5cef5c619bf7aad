#include "veridyn/io/tables/unit_words.hpp"

#include <gtest/gtest.h>

#include <string>

#include "veridyn/core/units.hpp"

namespace veridyn::io {
namespace {

TEST(UnitWords, ReadsUnitsAsPeopleWriteThem) {
  const std::pair<const char*, const char*> cases[] = {{"deg/sec", "deg/s"},
                                                       {"Degrees", "deg"},
                                                       {"\xC2\xB0/s", "deg/s"},
                                                       {"\xB0", "deg"},
                                                       {"m/s\xC2\xB2", "m/s^2"},
                                                       {"m/s2", "m/s^2"},
                                                       {"m/s/s", "m/s^2"},
                                                       {"knots", "kt"},
                                                       {"kts", "kt"},
                                                       {"KM/H", "km/h"},
                                                       {"KIAS", "kt"},
                                                       {"RPM", "rpm"},
                                                       {"lbs", "lb"},
                                                       {"PSI", "psi"},
                                                       {"inch Hg", "inHg"},
                                                       {"deg F", "degF"},
                                                       {"ft/min", "ft/min"},
                                                       {"fpm", "ft/min"},
                                                       {"ft msl", "ft"},
                                                       {"km/hr", "km/h"},
                                                       {"g's", "g"},
                                                       {"G", "G"},
                                                       {"kN", "kN"},
                                                       {"\xC2\xB0"
                                                        "C",
                                                        "degC"},
                                                       {"Sec", "s"},
                                                       {"msec", "ms"},
                                                       {"\xC2\xB5s", "us"},
                                                       {"feet/second", "ft/s"},
                                                       {"rads/sec", "rad/s"},
                                                       {" % ", "%"}};
  for (const auto& [text, expected] : cases) {
    const auto unit = unit_in_words(text);
    if (std::string(expected).empty()) {
      EXPECT_FALSE(unit) << text;
      continue;
    }
    ASSERT_TRUE(unit) << text;
    const Unit read = parse_unit(*unit), meant = parse_unit(expected);
    EXPECT_TRUE(read.same_dimension(meant)) << text;
    EXPECT_DOUBLE_EQ(read.scale, meant.scale) << text;
  }
}

TEST(UnitWords, RefusesWhatIsNoUnitOrMeansTwoThings) {
  for (const char* text : {"", "filtered", "rps", "m//s", "C", "d", "UTC"}) EXPECT_FALSE(unit_in_words(text)) << text;
  EXPECT_FALSE(unit_in_words(std::string(100, 'm')));
}

TEST(UnitWords, TakeGByTheNameOfTheColumn) {
  EXPECT_EQ(unit_of_column("G", "NormAc"), "g");
  EXPECT_EQ(unit_of_column("G", "MagX"), "G");
  EXPECT_EQ(unit_of_column("mG", "MagX"), "mG");
  EXPECT_EQ(unit_of_column("kts", "TAS"), "kt");
}

}  // namespace
}  // namespace veridyn::io
