#include "veridyn/io/tables/csv_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::io::internal {
namespace {

TEST(CsvCells, GuessesTheDelimiterThatTheLineHoldsMostOf) {
  EXPECT_EQ(guess_delimiter("time;speed;note, with a comma"), ';');
  EXPECT_EQ(guess_delimiter("time\tspeed\tyaw"), '\t');
  EXPECT_EQ(guess_delimiter("time,speed"), ',');
  EXPECT_EQ(guess_delimiter("_totl,_time | _Vind,_kias |"), '|');
  EXPECT_EQ(guess_delimiter("time"), ',');
}

TEST(CsvCells, KnowsCellsThatAreNoPlainNumber) {
  bool infinite = false;
  for (const char* missing : {"", "NA", "nan", "NaN"}) {
    const auto value = unusual_number(missing, infinite);
    ASSERT_TRUE(value.has_value()) << missing;
    EXPECT_TRUE(std::isnan(*value)) << missing;
  }
  EXPECT_EQ(unusual_number("true", infinite), 1.0);
  EXPECT_EQ(unusual_number("false", infinite), 0.0);
  EXPECT_FALSE(unusual_number("fast", infinite).has_value());
  EXPECT_FALSE(infinite);
  EXPECT_TRUE(std::isnan(*unusual_number("inf", infinite)));
  EXPECT_TRUE(infinite);
}

TEST(CsvCells, BlanksSeparateWhereNothingElseDoes) {
  EXPECT_EQ(guess_delimiter("time p q"), ' ');
  CellReader reader("  1.5   +2\t-3 \n4 word\t5\n6", ' ');
  double value = 0.0;
  for (const double expected : {1.5, 2.0, -3.0, 4.0}) {
    ASSERT_TRUE(reader.number(value)) << expected;
    EXPECT_EQ(value, expected);
  }
  EXPECT_FALSE(reader.last_cell_of_row());
  EXPECT_FALSE(reader.number(value));
  EXPECT_EQ(reader.text(), "word");
  ASSERT_TRUE(reader.number(value));
  EXPECT_TRUE(reader.last_cell_of_row());
  ASSERT_TRUE(reader.number(value));
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(reader.lines(), 3U);
  // A carriage return within a line is a blank: every cell that is taken leads on.
  CellReader returns("a \r\xc7 b", ' ');
  EXPECT_EQ(returns.text(), "a");
  EXPECT_EQ(returns.text(), "\xc7");
  EXPECT_EQ(returns.text(), "b");
  EXPECT_TRUE(returns.at_end());
  // A number that goes on as a word is a word.
  CellReader glued("12ab 3", ' ');
  EXPECT_FALSE(glued.number(value));
  EXPECT_EQ(glued.text(), "12ab");
}

TEST(CsvCells, ReadsADecimalCommaWhereTheTableHasOne) {
  EXPECT_TRUE(has_decimal_comma("t;x\n0;1,5\n", ';'));
  EXPECT_FALSE(has_decimal_comma("t;x\n0;1.5\n1;1,5\n", ';'));
  EXPECT_FALSE(has_decimal_comma("t,x\n0,1\n", ','));
  bool infinite = false;
  EXPECT_EQ(unusual_number("-1,5e2", infinite, true), -150.0);
  EXPECT_FALSE(unusual_number("1.234,5", infinite, true));
  EXPECT_FALSE(unusual_number("1,234,567", infinite, true));
  EXPECT_FALSE(unusual_number("1,5", infinite));
  CellReader reader("0,25;7\n", CellStyle{';', true});
  EXPECT_EQ(reader.unusual(infinite), 0.25);
}

TEST(CsvCells, TakesNumbersCellByCell) {
  CellReader reader("1.5, +2e3 ,x\r\n-4", ',');
  double value = 0.0;
  ASSERT_TRUE(reader.number(value));
  EXPECT_EQ(value, 1.5);
  ASSERT_TRUE(reader.number(value));
  EXPECT_EQ(value, 2000.0);
  EXPECT_FALSE(reader.last_cell_of_row());
  const char* before = reader.position();
  EXPECT_FALSE(reader.number(value));
  EXPECT_EQ(reader.position(), before);
  EXPECT_EQ(reader.text(), "x");
  EXPECT_TRUE(reader.last_cell_of_row());
  EXPECT_TRUE(reader.row_has_newline());
  ASSERT_TRUE(reader.number(value));
  EXPECT_EQ(value, -4.0);
  EXPECT_TRUE(reader.last_cell_of_row());
  EXPECT_FALSE(reader.row_has_newline());
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(reader.lines(), 2u);
}

TEST(CsvCells, TakesQuotesAsInRfc4180) {
  CellReader reader("\"a, \"\"b\"\"\",plain\n", ',');
  EXPECT_EQ(reader.text(), "a, \"b\"");
  EXPECT_EQ(reader.text(), "plain");
  EXPECT_TRUE(reader.at_end());
}

}  // namespace
}  // namespace veridyn::io::internal
