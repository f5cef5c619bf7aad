#include "veridyn/vehicle/tyre/tir_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/vehicle/tyre/refused_tir.hpp"

namespace veridyn::vehicle {
namespace {

using ::testing::HasSubstr;
using testing::message_of;
using testing::replaced;

TEST(TirReader, RefusesWhatIsNoTyreFileInOneLine) {
  EXPECT_THAT(message_of(""), HasSubstr("t.tir: is no tyre file"));
  EXPECT_THAT(message_of("! only a comment\n"), HasSubstr("no line KEY = value"));
  EXPECT_THAT(message_of(std::string("\x7f"
                                     "ELF\x02\x01\0\0",
                                     8)),
              HasSubstr("t.tir:1: is no tyre file: this line is not text"));
  EXPECT_THAT(message_of(std::string(5 << 20, 'x')), HasSubstr("a tyre file has at most"));
  EXPECT_THAT(message_of("time[s],u[m/s]\n0,1\n"), HasSubstr("t.tir:1: 'time[s],u[m/s]' is neither"));
  EXPECT_THAT(message_of("[MODEL]\nUSE_MODE = 4\n"), HasSubstr("PROPERTY_FILE_FORMAT is missing"));
}

TEST(TirReader, RefusesBadLinesAndNumbersNamingTheirLine) {
  EXPECT_THAT(message_of(replaced("PCX1 = 1.6", "PCX1 = nan")), HasSubstr("PCX1 = nan must be finite"));
  EXPECT_THAT(message_of(replaced("PCX1 = 1.6", "PCX1 = 1e999")), HasSubstr("must be finite"));
  EXPECT_THAT(message_of(replaced("PCX1 = 1.6", "PCX1 = 1.6x")), HasSubstr("PCX1 = 1.6x is not a number"));
  EXPECT_THAT(message_of(replaced("PCX1 = 1.6", "PCX1 = '1.6'")), HasSubstr("is not a number"));
  EXPECT_THAT(message_of(replaced("PCX1 = 1.6", "PCX1 =")), HasSubstr("PCX1 has no value"));
  EXPECT_THAT(message_of(replaced("PCX1 = 1.6", "PCX1 1.6")), HasSubstr("t.tir:35: 'PCX1 1.6' is neither"));
  EXPECT_THAT(message_of(replaced("PDX1 = 1.15", "PCX1 = 1.15")),
              HasSubstr("t.tir:36: PCX1 is given twice, first in line 35"));
  EXPECT_THAT(message_of(replaced("'PAC2002'", "'PAC2002")),
              HasSubstr("t.tir:10: PROPERTY_FILE_FORMAT: the closing quote"));
  EXPECT_THAT(message_of(replaced("[MODEL]", "[MODEL")), HasSubstr("t.tir:9: '[MODEL'"));
}

}  // namespace
}  // namespace veridyn::vehicle
