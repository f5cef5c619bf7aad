#include "veridyn/numerics/moments.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace veridyn::numerics {
namespace {

TEST(Moments, AreThoseOfTheSamples) {
  Moments m;
  for (const double x : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}) m.add(x);
  EXPECT_EQ(m.count, 8.0);
  EXPECT_EQ(m.mean(), 5.0);
  EXPECT_DOUBLE_EQ(m.rms(), std::sqrt(29.0));
  EXPECT_EQ(m.sd(), 2.0);
}

TEST(Moments, OfNothingAreZero) {
  const Moments m;
  EXPECT_EQ(m.mean(), 0.0);
  EXPECT_EQ(m.rms(), 0.0);
  EXPECT_EQ(m.sd(), 0.0);
}

TEST(Mean, AddsInOrder) {
  const std::array<double, 4> values = {1e16, 1.0, -1e16, 3.0};
  EXPECT_EQ(mean(values), 0.75) << "1 is lost beside 1e16";
  EXPECT_EQ(mean({}), 0.0);
  const std::array<double, 2> with_none = {1.0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_TRUE(std::isnan(mean(with_none)));
}

}  // namespace
}  // namespace veridyn::numerics
