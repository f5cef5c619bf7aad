#include "veridyn/core/unit_spellings.hpp"

#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn {
namespace {

TEST(UnitSpellings, AreReadWhereverAUnitIs) {
  EXPECT_DOUBLE_EQ(parse_unit("lbs").to_si(1.0), 0.45359237);
  EXPECT_DOUBLE_EQ(parse_unit("deg/sec").scale, parse_unit("deg/s").scale);
  EXPECT_DOUBLE_EQ(parse_unit("KIAS").scale, parse_unit("kt").scale);
  EXPECT_DOUBLE_EQ(parse_unit("slug-ft2").scale, parse_unit("slug ft^2").scale);
  EXPECT_NEAR(parse_unit("ft-lbs").to_si(1.0), 1.3558179, 1e-7);  // NIST SP 811, appendix B: foot pound-force
  EXPECT_NEAR(parse_unit("Rankine").to_si(518.67), 288.15, 1e-12);
  EXPECT_EQ(parse_unit("deg/sec").name, "deg/sec") << "as it was written";
  EXPECT_EQ(in_standard_words("\xC2\xB0/sec"), "deg/s");
  EXPECT_EQ(in_standard_words("parsek"), "parsek");
}

TEST(UnitSpellings, OfTwoMeaningsTheOneOfTheQuantityIsTaken) {
  EXPECT_DOUBLE_EQ(parse_unit_like("G", parse_unit("m/s^2")).to_si(1.0), 9.80665);
  EXPECT_DOUBLE_EQ(parse_unit_like("G", parse_unit("T")).to_si(1.0), 1e-4);
  EXPECT_NEAR(parse_unit_like("lbs", parse_unit("N")).to_si(1.0), 4.4482216, 1e-7);
  EXPECT_DOUBLE_EQ(parse_unit_like("lbs", parse_unit("kg")).to_si(1.0), 0.45359237);
  EXPECT_EQ(unit_meant("kt", parse_unit("m")), "kt");
  EXPECT_THROW(static_cast<void>(parse_unit_like("G", parse_unit("m"))), InputError);
}

}  // namespace
}  // namespace veridyn
