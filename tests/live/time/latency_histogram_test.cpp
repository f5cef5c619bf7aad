#include "veridyn/live/time/latency_histogram.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::live {
namespace {

TEST(LatencyHistogram, QuantilesAreThoseOfWhatWentInToABin) {
  LatencyHistogram h;
  EXPECT_TRUE(std::isnan(h.quantile(0.5)));
  for (int k = 1; k <= 10000; ++k) h.add(k * 1000);  // 1 us to 10 ms, evenly
  EXPECT_EQ(h.count(), 10000U);
  EXPECT_NEAR(h.mean(), 5.0005e-3, 1e-12);
  const double bin = std::pow(10.0, 1.0 / LatencyHistogram::kPerDecade);
  for (const double share : {0.01, 0.5, 0.99, 0.9999}) {
    EXPECT_GE(h.quantile(share), share * 1e-2 * 0.9999) << share;
    EXPECT_LE(h.quantile(share), share * 1e-2 * bin * 1.0001) << share;
  }
  EXPECT_EQ(h.quantile(1.0), 1e-2);
}

TEST(LatencyHistogram, TakesWhatIsShorterAndLongerThanItsBins) {
  LatencyHistogram h;
  h.add(-5);
  h.add(0);
  h.add(1000 * kSecond);
  EXPECT_EQ(h.bins().front(), 2U);
  EXPECT_EQ(h.bins().back(), 1U);
  EXPECT_EQ(h.largest(), 1000 * kSecond);
}

}  // namespace
}  // namespace veridyn::live
