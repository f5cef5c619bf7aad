#include "veridyn/io/tables/number_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"

namespace veridyn::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(NumberTable, ReadsNumbersAsTheyLieWithNamesAndUnits) {
  const NumberTable t = read_number_table("# made by hand\nz[N],alpha (deg),run\n1,2.5,a\n\n-3e2,,b\n", "t.csv");
  ASSERT_EQ(t.rows, 2U);
  EXPECT_THAT(t.at("z").number, ElementsAre(1.0, -300.0));
  EXPECT_EQ(t.at("z").unit, "N");
  EXPECT_EQ(t.at("alpha").unit, "deg");
  EXPECT_EQ(t.at("alpha").number[0], 2.5) << "not converted";
  EXPECT_TRUE(std::isnan(t.at("alpha").number[1]));
  EXPECT_FALSE(t.at("run").is_number());
  EXPECT_THAT(t.at("run").text, ElementsAre("a", "b"));
}

TEST(NumberTable, TakesTheSeparatorOfItsHeader) {
  EXPECT_THAT(read_number_table("  y   x\n 1  2\n\t3 4\n", "t").at("x").number, ElementsAre(2.0, 4.0));
  EXPECT_THAT(read_number_table("y;x\r\n1;2\r\n", "t").at("x").number, ElementsAre(2.0));
  EXPECT_THAT(read_number_table("y\tx\n1\t+2\n", "t").at("x").number, ElementsAre(2.0));
}

TEST(NumberTable, SaysWhatIsWrongAndWhere) {
  const auto refusal = [](const char* text) {
    return why([&] { static_cast<void>(read_number_table(text, "t.csv")); });
  };
  EXPECT_EQ(refusal("a,b\n1,2\n3\n"), "t.csv:3: has 1 cells where the header has 2");
  EXPECT_EQ(refusal("a,a\n1,2\n"), "t.csv:1: the column 'a' appears twice");
  EXPECT_EQ(refusal("a,\n1,2\n"), "t.csv:1: a column has no name");
  EXPECT_EQ(refusal("a,b\n"), "t.csv: holds no rows under a row of names");
  const NumberTable t = read_number_table("speed\n1\n", "t.csv");
  EXPECT_THAT(why([&] { static_cast<void>(t.at("sped")); }), HasSubstr("has no column 'sped'"));
}

}  // namespace
}  // namespace veridyn::io
