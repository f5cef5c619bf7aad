#include "veridyn/live/time/fixed_rate.hpp"

#include <gtest/gtest.h>

namespace veridyn::live {
namespace {

TEST(FixedRate, DeadlinesStayOnTheGridWhateverStepsTake) {
  FixedRate rate(1000, 100);
  EXPECT_EQ(rate.next(), 1000);
  EXPECT_EQ(rate.advance(1001), 0U);
  EXPECT_EQ(rate.next(), 1100);
  EXPECT_EQ(rate.advance(1299), 0U);  // late, but the next deadline has only just passed
  EXPECT_EQ(rate.next(), 1200);
  EXPECT_EQ(rate.advance(1555), 2U);
  EXPECT_EQ(rate.next(), 1500);
  EXPECT_EQ(rate.left_out(), 2U);
}

}  // namespace
}  // namespace veridyn::live
