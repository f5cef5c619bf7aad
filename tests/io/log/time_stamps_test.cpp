#include "veridyn/io/log/time_stamps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::io {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(OrderStamps, LeavesStampsInOrderAloneWhateverTheirGaps) {
  const OrderedStamps result = order_stamps({0.0, 0.1, 0.2, 500.0, 500.1, 9000.0});
  EXPECT_THAT(result.time, ElementsAre(0.0, 0.1, 0.2, 500.0, 500.1, 9000.0));
  EXPECT_THAT(result.row, IsEmpty());
  EXPECT_EQ(result.spikes + result.reordered + result.doubled, 0U);
}

TEST(OrderStamps, DropsAnIsolatedStampFarAheadOrFarBack) {
  std::vector<double> stamps;
  for (int i = 0; i < 20; ++i) stamps.push_back(100.0 + 0.1 * i);
  stamps[5] = 1e9;
  stamps[12] = 0.0;
  const OrderedStamps result = order_stamps(stamps);
  EXPECT_EQ(result.spikes, 2U);
  EXPECT_EQ(result.reordered, 0U);
  EXPECT_EQ(result.time.size(), 18U);
  EXPECT_DOUBLE_EQ(result.time[5], 100.6);
  EXPECT_EQ(result.row[5], 6U);
}

TEST(OrderStamps, DropsUpToFourBadStampsInARow) {
  std::vector<double> stamps;
  for (int i = 0; i < 30; ++i) stamps.push_back(100.0 + 0.1 * i);
  for (int i = 10; i < 14; ++i) stamps[i] = 5e6;
  EXPECT_EQ(order_stamps(stamps).spikes, 4U);
}

TEST(OrderStamps, DropsAFirstStampFarAheadOfTheRest) {
  const OrderedStamps result = order_stamps({1e9, 1.0, 1.1, 1.2, 1.3, 1.4});
  EXPECT_THAT(result.time, ElementsAre(1.0, 1.1, 1.2, 1.3, 1.4));
}

TEST(OrderStamps, DropsALastStampFarBack) {
  const OrderedStamps result = order_stamps({100.0, 100.1, 100.2, 100.3, 100.4, 3.0});
  EXPECT_EQ(result.spikes, 1U);
  EXPECT_DOUBLE_EQ(result.time.back(), 100.4);
}

TEST(OrderStamps, SortsNeighboursThatStandInTheWrongOrderAndKeepsEqualOnesAsTheyAre) {
  const OrderedStamps result = order_stamps({0.0, 0.2, 0.1, 0.2, 0.3});
  EXPECT_THAT(result.time, ElementsAre(0.0, 0.1, 0.2, 0.2, 0.3));
  EXPECT_THAT(result.row, ElementsAre(0U, 2U, 1U, 3U, 4U));
  EXPECT_EQ(result.reordered, 1U);
  EXPECT_EQ(result.doubled, 1U);
}

TEST(OrderStamps, DropsStampsThatAreNoNumber) {
  const OrderedStamps result = order_stamps({0.0, std::nan(""), 0.2, INFINITY, 0.4});
  EXPECT_THAT(result.time, ElementsAre(0.0, 0.2, 0.4));
  EXPECT_EQ(result.spikes, 2U);
}

TEST(OrderStamps, TakesNothingAndSingleStamps) {
  EXPECT_TRUE(order_stamps({}).time.empty());
  EXPECT_THAT(order_stamps({7.0}).time, ElementsAre(7.0));
  EXPECT_TRUE(order_stamps({std::nan("")}).time.empty());
}

}  // namespace
}  // namespace veridyn::io
