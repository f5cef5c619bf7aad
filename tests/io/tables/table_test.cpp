#include "veridyn/io/tables/table.hpp"

#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace veridyn::io {
namespace {

TEST(Table, IsReadWhateverSeparatesItsColumns) {
  for (const char* text : {"x[mm],y\n1,2\n3,4\n", "x[mm]; y;\n1; 2;\n3; 4\n", "x[mm]\ty\n1\t2\n3\t4\n"}) {
    const Table table = parse_table(text, "t");
    ASSERT_EQ(table.columns.size(), 2U) << text;
    EXPECT_EQ(table.at("x").value, (std::vector<double>{0.001, 0.003})) << text;
    EXPECT_EQ(table.at("y").value, (std::vector<double>{2.0, 4.0})) << text;
  }
}

TEST(Table, KnowsTheLinesOfItsRows) {
  const Table table = parse_table("# note\nx,y\n1,2\n\n# note\n3,4\n", "t");
  EXPECT_EQ(table.lines, (std::vector<std::size_t>{3, 6}));
}

TEST(Table, RefusesRowsOfAnotherLength) {
  EXPECT_EQ(why([] { (void)parse_table("x;y;\n1;2;\n1;2;3;\n", "t"); }), "t:3: has 3 cells, the header 2");
  EXPECT_EQ(why([] { (void)parse_table("x,,y\n1,2,3\n", "t"); }), "t:1: a column of the header has no name");
}

}  // namespace
}  // namespace veridyn::io
