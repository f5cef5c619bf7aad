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

TEST(Enumerators, AreInOrder) {
  constexpr auto kSides = enumerators<Side, 3>();
  static_assert(kSides.size() == 3 && kSides[2] == Side::kBoth);
  EnumArray<Side, int, 3> order{};
  int next = 0;
  for (const Side side : kSides) order[side] = next++;
  EXPECT_EQ(order[Side::kLeft], 0);
  EXPECT_EQ(order[Side::kRight], 1);
  EXPECT_EQ(order[Side::kBoth], 2);
}

}  // namespace
}  // namespace veridyn
