#include "veridyn/vehicle/road/profile_road.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"
#include "tests/vehicle/road/roads.hpp"

namespace veridyn::vehicle {
namespace {

using testing::at;
using ::testing::HasSubstr;

TEST(ProfileRoad, IsStraightBetweenItsPointsAndLevelBeyond) {
  for (const double bend : {0.0, 0.3}) {  // evenly spaced, and not
    const ProfileRoad road({1.0, 2.0 + bend, 3.0}, {0.0, 0.1, 0.3}, {0.0, -0.1, 0.5});
    EXPECT_EQ(road.height(at(0.0, 1.0)), 0.0);
    EXPECT_EQ(road.height(at(9.0, 1.0)), 0.3);
    EXPECT_EQ(road.height(at(9.0, -1.0)), 0.5);
    EXPECT_NEAR(road.height(at(1.0 + 0.5 * (1.0 + bend), 1.0)), 0.05, 1e-15);
    EXPECT_NEAR(road.height(at(2.0 + bend, -1.0)), -0.1, 1e-15);
    EXPECT_NEAR(road.height(at(2.0 + bend, 0.0)), 0.0, 1e-15);
  }
}

TEST(ProfileRoad, ReadsATable) {
  const ProfileRoad both = profile_road(io::parse_table("distance[m],height[cm]\n0,0\n1,5\n", "p.csv"));
  EXPECT_DOUBLE_EQ(both.height(at(0.5)), 0.025);
  const ProfileRoad sides = profile_road(io::parse_table("right[m],distance[m],left[m]\n0,0,1\n0,1,1\n", "p.csv"));
  EXPECT_EQ(sides.height(at(0.5, 1.0)), 1.0);
  EXPECT_EQ(sides.height(at(0.5, -1.0)), 0.0);
  const auto refusal = [](const char* text) {
    return why([&] { (void)profile_road(io::parse_table(text, "p.csv")); });
  };
  EXPECT_THAT(refusal("distance[m],left[m]\n0,0\n1,0\n"), HasSubstr("p.csv: has no column 'right'"));
  EXPECT_THAT(refusal("distance[s],height[m]\n0,0\n1,0\n"), HasSubstr("column 'distance' is in [s]"));
  EXPECT_THAT(refusal("distance[m],height[m]\n0,0\n0,0\n"), HasSubstr("distance of row 1 is 0; must be more than"));
  EXPECT_THAT(refusal("distance[m],height[m]\n0,0\n1,\n"), HasSubstr("left height of row 1 is nan"));
  EXPECT_THAT(refusal("distance[m],height[m]\n0,0\n"), HasSubstr("has 1 points"));
}

}  // namespace
}  // namespace veridyn::vehicle
