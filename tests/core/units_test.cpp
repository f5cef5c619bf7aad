#include "veridyn/core/units.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "veridyn/core/error.hpp"

namespace veridyn {
namespace {

std::string message_of(std::string_view unit, std::string_view expected = "1") {
  try {
    static_cast<void>(parse_unit_like(unit, parse_unit(expected)));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// Conversion factors of NIST SP 811, appendix B.
TEST(Units, ConvertToSi) {
  EXPECT_DOUBLE_EQ(parse_unit("deg").to_si(180.0), std::numbers::pi);
  EXPECT_DOUBLE_EQ(parse_unit("deg/s").to_si(1.0), std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(parse_unit("g").to_si(2.0), 19.6133);
  EXPECT_NEAR(parse_unit("kt").to_si(1.0), 0.5144444444444444, 1e-15);
  EXPECT_DOUBLE_EQ(parse_unit("ft/s").to_si(1.0), 0.3048);
  EXPECT_NEAR(parse_unit("psf").to_si(1.0), 47.88026, 5e-6);
  EXPECT_NEAR(parse_unit("psi").to_si(1.0), 6894.757, 5e-4);
  EXPECT_NEAR(parse_unit("slug").to_si(1.0), 14.59390, 5e-6);
  EXPECT_NEAR(parse_unit("lbf").to_si(1.0), 4.448222, 5e-7);
  EXPECT_NEAR(parse_unit("slug ft^2").to_si(1.0), 1.355818, 5e-7);
  EXPECT_DOUBLE_EQ(parse_unit("degC").to_si(15.0), 288.15);
  EXPECT_NEAR(parse_unit("degF").to_si(59.0), 288.15, 1e-12);
  EXPECT_NEAR(parse_unit("rpm").to_si(60.0), 2.0 * std::numbers::pi, 1e-12);
  EXPECT_DOUBLE_EQ(parse_unit("%").to_si(50.0), 0.5);
}

TEST(Units, ComposeProductsPowersAndQuotients) {
  EXPECT_TRUE(parse_unit("kg m/s^2").same_dimension(parse_unit("N")));
  EXPECT_TRUE(parse_unit("N/m2").same_dimension(parse_unit("Pa")));
  EXPECT_TRUE(parse_unit("m s^-2").same_dimension(parse_unit("g")));
  EXPECT_TRUE(parse_unit("rad/s/s").same_dimension(parse_unit("rad/s^2")));
  EXPECT_TRUE(parse_unit("").same_dimension(parse_unit("1")));
  EXPECT_DOUBLE_EQ(parse_unit("cm^2").to_si(1.0), 1e-4);
  EXPECT_NEAR(parse_unit("1/deg").to_si(1.0), 180.0 / std::numbers::pi, 1e-12);
  EXPECT_DOUBLE_EQ(parse_unit("W/degC").to_si(3.0), 3.0);
}

TEST(Units, NameTheirSiUnit) {
  EXPECT_EQ(parse_unit("deg/s").si_name(), "rad/s");
  EXPECT_EQ(parse_unit("ft/s^2").si_name(), "m/s^2");
  EXPECT_EQ(parse_unit("psf").si_name(), "Pa");
  EXPECT_EQ(parse_unit("1/deg").si_name(), "1/rad");
  EXPECT_EQ(parse_unit("lb ft^2").si_name(), "kg m^2");
  EXPECT_EQ(parse_unit("%").si_name(), "1");
  EXPECT_EQ(parse_unit("lbf ft").si_name(), "N m") << "a moment is not named in joules";
}

TEST(Units, ParseWhatTheyPrint) {
  for (const char* name : {"m/s^2", "rad/s", "kg m^2", "1/rad", "kg/m^3", "N", "Pa", "Hz", "T", "V", "K"}) {
    EXPECT_TRUE(parse_unit(parse_unit(name).si_name()).same_dimension(parse_unit(name))) << name;
    EXPECT_DOUBLE_EQ(parse_unit(name).to_si(2.0), 2.0) << name;
  }
}

TEST(Units, RoundTripThroughSi) {
  for (const char* name : {"degF", "kt", "psf", "deg/s", "inHg", "mG"}) {
    const Unit unit = parse_unit(name);
    EXPECT_NEAR(unit.from_si(unit.to_si(12.5)), 12.5, 1e-9) << name;
  }
}

TEST(Units, RefuseWhatTheyDoNotKnow) {
  EXPECT_THAT(message_of("parsek/s"), testing::HasSubstr("unknown unit 'parsek' in 'parsek/s' (known: "));
  EXPECT_THAT(message_of("degg"), testing::HasSubstr("did you mean 'deg'?"));
  EXPECT_EQ(message_of("m", "kg"), "unit 'm' is a length [m], expected a mass [kg]");
  EXPECT_EQ(message_of("Hz", "rad/s"), "unit 'Hz' is a frequency [Hz], expected an angular rate [rad/s]");
  EXPECT_THAT(message_of("m/"), testing::HasSubstr("not a unit"));
  EXPECT_THAT(message_of("//s"), testing::HasSubstr("nothing before"));
  EXPECT_THAT(message_of("m^x"), testing::HasSubstr("power 'x'"));
}

}  // namespace
}  // namespace veridyn
