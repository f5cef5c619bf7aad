#include "veridyn/report/document/decimate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

struct Recording {
  std::vector<double> x;
  std::vector<double> y;
};

Recording noisy(std::size_t samples, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Recording recording;
  for (std::size_t k = 0; k < samples; ++k) {
    recording.x.push_back(0.02 * static_cast<double>(k));
    recording.y.push_back(normal(engine));
  }
  return recording;
}

std::size_t gaps(const std::vector<double>& y) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < y.size(); ++k) {
    if (std::isnan(y[k]) && (k == 0 || !std::isnan(y[k - 1]))) ++count;
  }
  return count;
}

TEST(DecimateLine, LeavesShortLinesAsTheyAre) {
  const std::vector<double> x = {0, 1, 2};
  const std::vector<double> y = {kNaN, 4, -1};
  const Polyline line = decimate_line(x, y, 8);
  EXPECT_EQ(line.x, x);
  EXPECT_TRUE(std::isnan(line.y[0]));
  EXPECT_EQ(line.y[2], -1);
}

// Any stretch of the line wider than two buckets has its extremes among the kept points.
TEST(DecimateLine, KeepsTheExtremesOfEveryStretch) {
  const Recording all = noisy(100'000, 1);
  const Polyline line = decimate_line(all.x, all.y, 4000);
  EXPECT_LE(line.x.size(), 4000u);
  EXPECT_TRUE(std::is_sorted(line.x.begin(), line.x.end(), std::less_equal<>{}) || line.x.size() < 2);
  constexpr std::size_t kBuckets = 1999;
  for (std::size_t k = 0; k < kBuckets; ++k) {
    const std::size_t begin = k * all.y.size() / kBuckets;
    const std::size_t end = (k + 1) * all.y.size() / kBuckets;
    const auto [low, high] =
        std::minmax_element(all.y.begin() + static_cast<long>(begin), all.y.begin() + static_cast<long>(end));
    for (const auto extreme : {low, high}) {
      const double at = all.x[extreme - all.y.begin()];
      const auto found = std::lower_bound(line.x.begin(), line.x.end(), at);
      ASSERT_TRUE(found != line.x.end() && *found == at) << "bucket " << k;
      ASSERT_EQ(line.y[found - line.x.begin()], *extreme);
    }
  }
}

TEST(DecimateLine, KeepsASpikeOfOneSampleAndBothEnds) {
  std::vector<double> x;
  std::vector<double> y;
  for (int k = 0; k < 180'000; ++k) {
    x.push_back(k);
    y.push_back(k == 77'777 ? 9.0 : 0.0);
  }
  const Polyline line = decimate_line(x, y, 1000);
  EXPECT_LE(line.x.size(), 1000u);
  EXPECT_EQ(line.x.front(), 0.0);
  EXPECT_EQ(line.x.back(), 179'999.0);
  EXPECT_THAT(line.y, testing::Contains(9.0));
  EXPECT_THAT(line.x, testing::Contains(77'777.0));
}

TEST(DecimateLine, KeepsEveryGapHoweverShort) {
  Recording all = noisy(50'000, 2);
  all.y[12'345] = kNaN;
  std::fill(all.y.begin() + 30'000, all.y.begin() + 41'000, kNaN);
  all.y[45'001] = std::numeric_limits<double>::infinity();
  const Polyline line = decimate_line(all.x, all.y, 500);
  EXPECT_EQ(gaps(line.y), 3u);
  EXPECT_LE(line.x.size(), 500u + 6u);
  EXPECT_TRUE(std::is_sorted(line.x.begin(), line.x.end()));
  for (std::size_t k = 0; k < line.x.size(); ++k) {
    EXPECT_FALSE(std::isfinite(line.y[k]) && line.x[k] >= all.x[30'000] && line.x[k] < all.x[41'000]);
  }
}

TEST(DecimateLine, SurvivesALineOfNothing) {
  const std::vector<double> x(10'000, 0.0);
  const std::vector<double> y(10'000, kNaN);
  EXPECT_TRUE(decimate_line(x, y, 100).x.empty());
}

TEST(DecimateBand, IsNeverNarrowerThanTheBand) {
  const Recording centre = noisy(40'000, 3);
  std::vector<double> low;
  std::vector<double> high;
  for (const double y : centre.y) {
    low.push_back(y - 1.0);
    high.push_back(y + 2.0);
  }
  const DecimatedBand band = decimate_band(centre.x, low, high, 300);
  EXPECT_LE(band.x.size(), 300u);
  EXPECT_EQ(band.x.front(), centre.x.front());
  EXPECT_EQ(band.x.back(), centre.x.back());
  constexpr std::size_t kBuckets = 298;
  for (std::size_t k = 0; k < centre.x.size(); ++k) {
    // The point of this sample's bucket; the first of all is the left end.
    std::size_t index = k * kBuckets / centre.x.size();
    while ((index + 1) * centre.x.size() / kBuckets <= k) ++index;
    ASSERT_LE(band.low[index + 1], low[k]);
    ASSERT_GE(band.high[index + 1], high[k]);
  }
}

TEST(DecimateBand, BreaksAtAGap) {
  Recording centre = noisy(10'000, 4);
  centre.y[5'000] = kNaN;
  const DecimatedBand band = decimate_band(centre.x, centre.y, centre.y, 100);
  EXPECT_EQ(gaps(band.low), 1u);
  EXPECT_EQ(gaps(band.high), 1u);
}

TEST(ThinScatter, KeepsTheExtremesAndTheLimit) {
  const Recording all = noisy(200'000, 5);
  const Recording other = noisy(200'000, 6);
  const Polyline thin = thin_scatter(all.y, other.y, 4000);
  EXPECT_LE(thin.x.size(), 4000u);
  EXPECT_GT(thin.x.size(), 1000u);
  EXPECT_EQ(*std::max_element(thin.x.begin(), thin.x.end()), *std::max_element(all.y.begin(), all.y.end()));
  EXPECT_EQ(*std::min_element(thin.x.begin(), thin.x.end()), *std::min_element(all.y.begin(), all.y.end()));
  EXPECT_EQ(*std::max_element(thin.y.begin(), thin.y.end()), *std::max_element(other.y.begin(), other.y.end()));
  EXPECT_EQ(*std::min_element(thin.y.begin(), thin.y.end()), *std::min_element(other.y.begin(), other.y.end()));
}

TEST(ThinScatter, DropsWhatIsNoNumber) {
  const std::vector<double> x = {1, kNaN, 3, 4};
  const std::vector<double> y = {1, 2, kNaN, 4};
  EXPECT_THAT(thin_scatter(x, y, 8).x, testing::ElementsAre(1, 4));
}

}  // namespace
}  // namespace veridyn::report
