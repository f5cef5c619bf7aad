#include "veridyn/core/index.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace veridyn {
namespace {

TEST(Index, GoesBetweenSignedAndUnsigned) {
  static_assert(at(3) == std::size_t{3} && signed_index(std::size_t{3}) == 3);
  const std::vector<int> values{10, 11, 12};
  const int last = 2;
  EXPECT_EQ(values[last], 12);
  EXPECT_EQ(*(values.begin() + signed_index(values.size() - 2)), 11);
}

}  // namespace
}  // namespace veridyn
