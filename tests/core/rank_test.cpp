#include "veridyn/core/rank.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace veridyn {
namespace {

TEST(Rank, IsTheValueWithAsManyBelow) {
  std::vector<double> values = {5.0, -1.0, 3.0, 3.0, 8.0};
  EXPECT_EQ(value_of_rank(values, 0), -1.0);
  EXPECT_EQ(value_of_rank(values, 2), 3.0);
  EXPECT_EQ(value_of_rank(values, 3), 5.0);
  EXPECT_EQ(value_of_rank(values, 4), 8.0);
  EXPECT_EQ(value_of_rank(std::vector<std::int64_t>{7, 4, 9}, 1), 7);
}

TEST(Rank, UpperMedianIsOneOfTheValues) {
  EXPECT_EQ(upper_median(std::vector<double>{4.0}), 4.0);
  EXPECT_EQ(upper_median(std::vector<double>{9.0, 1.0, 4.0}), 4.0);
  EXPECT_EQ(upper_median(std::vector<double>{9.0, 1.0, 4.0, 6.0}), 6.0) << "the upper of 4 and 6";
}

TEST(Rank, OfAPartTakesNothingElse) {
  std::array<double, 5> values = {2.0, 1.0, 3.0, -10.0, -20.0};
  EXPECT_EQ(upper_median(std::span(values).first(3)), 2.0);
  EXPECT_EQ(values[3], -10.0);
  EXPECT_EQ(values[4], -20.0);
}

TEST(RankDeath, OfNothing) { EXPECT_DEATH((void)upper_median(std::vector<double>{}), "broken invariant"); }

}  // namespace
}  // namespace veridyn
