#include "veridyn/recording/gravity.hpp"

#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"

namespace veridyn::recording {
namespace {

using Holds = VerticalAcceleration::Holds;

TEST(VerticalAcceleration, TellsGravityItsUnitAndItsAbsence) {
  const Unit si = parse_unit("m/s^2");
  EXPECT_EQ(vertical_acceleration(9.6, si).holds, Holds::kGravity);
  EXPECT_TRUE(vertical_acceleration(-9.6, si).is_reversed(1.0));
  EXPECT_FALSE(vertical_acceleration(-9.6, si).is_reversed(-1.0));
  EXPECT_EQ(vertical_acceleration(1.01, si).unit, "g");
  EXPECT_EQ(vertical_acceleration(32.1, si).unit, "ft/s^2");
  EXPECT_EQ(vertical_acceleration(0.4, si).holds, Holds::kNothing);
  EXPECT_EQ(vertical_acceleration(2.0 * kGravity, si).holds, Holds::kTwice);
  EXPECT_EQ(vertical_acceleration(5.0, si).holds, Holds::kUnknown);
  // Numbers in m/s^2 that were taken for g.
  EXPECT_EQ(vertical_acceleration(kGravity * kGravity, parse_unit("g")).unit, "m/s^2");
  EXPECT_EQ(vertical_acceleration(kNaN, si).holds, Holds::kUnknown);
}

}  // namespace
}  // namespace veridyn::recording
