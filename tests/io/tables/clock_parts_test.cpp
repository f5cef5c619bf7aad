#include "veridyn/io/tables/clock_parts.hpp"

#include "tests/io/support.hpp"

namespace veridyn::io::internal {
namespace {

using testing::message_of;

TEST(ClockParts, AreTheRowsBetweenRestarts) {
  const std::vector<std::size_t> restarts{12, 30};
  const std::vector<ClockPart> parts = clock_parts(restarts, 40);
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[1].begin, 12U);
  EXPECT_EQ(parts[1].end, 30U);
  EXPECT_EQ(parts[2].end, 40U);
}

TEST(ClockParts, AreNoneWhereRowsAreOnlyOutOfOrder) {
  const std::vector<std::size_t> restarts{12, 14};
  EXPECT_TRUE(clock_parts(restarts, 40).empty());
}

TEST(ClockParts, TheLongestIsReadUnlessAnotherIsChosen) {
  std::vector<double> stamps;
  for (int i = 0; i < 10; ++i) stamps.push_back(i);
  for (int i = 0; i < 20; ++i) stamps.push_back(0.1 * i);
  const std::vector<ClockPart> parts{{0, 10}, {10, 30}};
  EXPECT_EQ(choose_part(parts, stamps, 0, "a.csv"), 0U);
  EXPECT_EQ(choose_part(parts, stamps, 2, "a.csv"), 1U);
  EXPECT_EQ(message_of([&] { static_cast<void>(choose_part(parts, stamps, 3, "a.csv")); }),
            "a.csv: has no part 3: its clock restarts 1 times, which makes 2 parts");
  EXPECT_EQ(parts_in_words(parts, stamps, 0),
            "the clock restarts: part 1 (rows 1 to 10, 0 s to 9 s), part 2 (rows 11 to 30, 0 s to 1.9 s); part 1 is "
            "read, `part = 2` in [data] takes another");
}

}  // namespace
}  // namespace veridyn::io::internal
