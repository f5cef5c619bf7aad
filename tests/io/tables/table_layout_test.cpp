#include "veridyn/io/tables/table_layout.hpp"

#include "tests/io/support.hpp"

namespace veridyn::io::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::message_of;

TEST(TableLayout, FindsNamesInTheFirstLineAndUnitsInTheSecond) {
  const TableLayout plain = find_layout("time;V\n0;1\n", {}, "a.csv");
  EXPECT_THAT(plain.names, ElementsAre("time", "V"));
  EXPECT_EQ(plain.style.delimiter, ';');
  EXPECT_EQ(plain.rows, "0;1\n");
  EXPECT_EQ(plain.header_line, 1U);
  EXPECT_EQ(plain.lines, 1U);
  const TableLayout units = find_layout("# a\ntime,V\ns,km/h\n0,1\n1,2\n", {}, "a.csv");
  EXPECT_THAT(units.units, ElementsAre("s", "km/h"));
  EXPECT_EQ(units.lines, 3U);
  EXPECT_EQ(units.header_line, 2U);
}

TEST(TableLayout, FindsNamesAndUnitsOfCommentsInAnyOrder) {
  const char* files[] = {"# t V p\n# s m/s deg/s\n0 1 2\n1 2 3\n", "% s m/s deg/s\n% t V p\n0 1 2\n1 2 3\n",
                         "# t V p\n# Double Float Float\n# s m/s deg/s\n0 1 2\n1 2 3\n"};
  for (const char* text : files) {
    const TableLayout layout = find_layout(text, {}, "a.txt");
    EXPECT_THAT(layout.names, ElementsAre("t", "V", "p")) << text;
    EXPECT_THAT(layout.units, ElementsAre("s", "m/s", "deg/s")) << text;
  }
}

TEST(TableLayout, HasNoNamesWhereThereIsNoHeader) {
  const TableLayout layout = find_layout("# of 2026\n0,1,2\n1,2,3\n", {}, "a.csv");
  EXPECT_THAT(layout.names, IsEmpty());
  EXPECT_EQ(layout.columns, 3U);
  EXPECT_EQ(layout.header_line, 2U);
}

TEST(TableLayout, TakesTypesForNamesWhereNothingElseIs) {
  EXPECT_THAT(find_layout("title\nfloat,double\n0,1\n1,2\n2,3\n", {}, "a.csv").names, ElementsAre("float", "double"));
  EXPECT_THAT(find_layout("# float double\n0 1\n1 2\n", {}, "a.csv").names, IsEmpty());
}

TEST(TableLayout, KeepsTheLinesAboveTheHeader) {
  const TableLayout layout = find_layout("title\nkey,value\n# remark\ntime,a,b\n0,1,2\n1,2,3\n2,3,4\n", {}, "a.csv");
  EXPECT_THAT(layout.names, ElementsAre("time", "a", "b"));
  ASSERT_EQ(layout.descriptions.size(), 2U);
  EXPECT_EQ(layout.descriptions[1].text, "key,value");
  EXPECT_EQ(layout.comments.size(), 1U);
  EXPECT_EQ(layout.header_line, 4U);
  EXPECT_EQ(layout.lines, 4U);
}

TEST(TableLayout, DoesNotTakeALastLineThatIsCutForTheTable) {
  const TableLayout layout = find_layout("title\ntime,a,b\n0,1,2\n1,2,3\n2,3,4\n3,4", {}, "a.csv");
  EXPECT_THAT(layout.names, ElementsAre("time", "a", "b"));
}

TEST(TableLayout, SkipsWhatTheOptionsSay) {
  EXPECT_THAT(find_layout("a,b\nc,d\ntime,V\n0,1\n", {.skip_lines = 2}, "a.csv").names, ElementsAre("time", "V"));
  EXPECT_EQ(message_of([] { static_cast<void>(find_layout("a\n", {.skip_lines = 2}, "a.csv")); }),
            "a.csv: has only 1 lines, skip_lines leaves nothing of it");
}

}  // namespace
}  // namespace veridyn::io::internal
