#include "veridyn/report/figures/curves.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;

TEST(Scaled, MultipliesEveryValue) { EXPECT_THAT(scaled(std::vector<double>{1.0, -2.0}, 3.0), ElementsAre(3.0, -6.0)); }

TEST(AnyFinite, IsFalseForGapsAlone) {
  EXPECT_FALSE(any_finite(std::vector<double>{kNaN, kInfinity}));
  EXPECT_TRUE(any_finite(std::vector<double>{kNaN, 0.0}));
}

TEST(WindowsOf, CutsWhereSamplesLieFarApart) {
  std::vector<double> time;
  for (const double begin : {20.0, 290.0}) {
    for (int k = 0; k <= 80; ++k) time.push_back(begin + 0.1 * k);
  }
  const std::vector<Window> windows = windows_of(time);
  ASSERT_EQ(windows.size(), 2U);
  EXPECT_NEAR(windows[0].from, 20.0, 1e-9);
  EXPECT_NEAR(windows[0].to, 28.0, 1e-9);
  EXPECT_NEAR(windows[1].from, 290.0, 1e-9);
  EXPECT_NEAR(windows[1].to, 298.0, 1e-9);
}

TEST(WindowsOf, LeavesOutASingleSample) {
  EXPECT_EQ(windows_of(std::vector<double>{0.0, 1.0, 2.0, 3.0, 500.0}).size(), 1U);
  EXPECT_TRUE(windows_of(std::vector<double>{1.0}).empty());
  EXPECT_TRUE(windows_of(std::vector<double>{}).empty());
}

TEST(SpansWhere, CoversEachRunFromItsFirstToItsLastMoment) {
  const std::vector<Span> spans = spans_where(std::vector<double>{0, 1, 2, 3, 4, 5},
                                              {true, true, false, false, true, true}, "held", SpanTone::kMuted);
  ASSERT_EQ(spans.size(), 2U);
  EXPECT_EQ(spans[0].from, 0.0);
  EXPECT_EQ(spans[0].to, 1.0);
  EXPECT_EQ(spans[1].from, 4.0);
  EXPECT_EQ(spans[1].to, 5.0);
  EXPECT_EQ(spans[1].label, "held");
}

TEST(FollowedLine, HidesWhatIsWildBeforeThereAreData) {
  const Line line = followed_line({1e6, 1.2, 1.0, 1.0}, std::vector<double>{1.0, kInfinity, 10.0, 0.1}, 1.0);
  EXPECT_TRUE(std::isnan(line.y[0]));
  EXPECT_TRUE(std::isnan(line.y[1]));
  EXPECT_EQ(line.y[2], 1.0);
  ASSERT_TRUE(line.band.has_value());
  EXPECT_TRUE(std::isnan(line.band->low[0]));
  EXPECT_EQ(line.band->low[2], -4.0);
  EXPECT_EQ(line.band->high[2], 4.0);
  EXPECT_NEAR(line.band->low[3], 1.0 - 0.1 * numerics::kNormal95, 1e-12);
  EXPECT_NEAR(line.band->high[3], 1.0 + 0.1 * numerics::kNormal95, 1e-12);
}

}  // namespace
}  // namespace veridyn::report
