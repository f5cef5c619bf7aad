#include "veridyn/core/enum_array.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace veridyn {
namespace {

enum class Side { kLeft, kRight, kBoth };

TEST(EnumArray, TakesEnumeratorsAndNumbers) {
  EnumArray<Side, double, 3> load{};
  load[Side::kRight] = 4.0;
  load[2] = 1.0;
  EXPECT_EQ(load[1], 4.0);
  EXPECT_EQ(load[Side::kBoth], 1.0);
  EXPECT_EQ(load[Side::kLeft], 0.0);
  EXPECT_EQ(std::accumulate(load.begin(), load.end(), 0.0), 5.0);
  load.fill(2.0);
  const auto copy = load;
  EXPECT_EQ(copy[Side::kLeft], 2.0);
}

}  // namespace
}  // namespace veridyn
