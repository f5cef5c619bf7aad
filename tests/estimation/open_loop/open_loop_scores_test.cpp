#include "veridyn/estimation/open_loop/open_loop_scores.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "veridyn/core/constants.hpp"

namespace veridyn::estimation {
namespace {

using testing::ElementsAre;

/// Two seconds at 1 Hz, the first of which gave the start.
OpenLoopForecast forecast(std::vector<double> measured, std::vector<double> predicted, double sigma, double horizon) {
  OpenLoopForecast f;
  f.window = {.group = "turns",
              .span = {10.0, 9.0 + static_cast<double>(measured.size())},
              .forecast_from = 11.0,
              .horizon_s = {horizon}};
  for (std::size_t k = 0; k < measured.size(); ++k) f.time.push_back(10.0 + static_cast<double>(k));
  f.shift_s = 100.0;
  f.measured = Eigen::Map<const Eigen::VectorXd>(measured.data(), std::ssize(measured));
  f.predicted = Eigen::Map<const Eigen::VectorXd>(predicted.data(), std::ssize(predicted));
  f.sigma = RowMatrix::Constant(std::ssize(measured), 1, sigma);
  return f;
}

std::vector<OpenLoopState> scores(const std::vector<OpenLoopForecast>& forecasts, const std::string& unit = "m/s") {
  const std::vector<ModelOutput> outputs{{"speed", unit}};
  const std::vector<std::string> groups{"turns"};
  return open_loop_scores(outputs, forecasts, groups, [](std::string_view) { return "turns"; });
}

TEST(OpenLoopScores, OfTheForecastAloneInClosedForm) {
  // The sample at 10 s, which gave the start, is 50 off and does not count.
  const auto s = scores({forecast({50.0, 1.0, 2.0, 3.0, 4.0}, {0.0, 1.1, 2.1, 3.1, 4.5}, 0.2, 2.5)});
  ASSERT_EQ(s.size(), 1u);
  EXPECT_EQ(s[0].fit.count, 4u);
  EXPECT_NEAR(s[0].fit.rmse, std::sqrt((3 * 0.01 + 0.25) / 4.0), 1e-12);
  EXPECT_NEAR(s[0].normalised_rmse, std::sqrt((0.28 / 4.0) / 1.25), 1e-12) << "variance of 1, 2, 3, 4: 1.25";
  EXPECT_EQ(s[0].inside, 0.75) << "0.5 is outside of 1.96 times 0.2";
  EXPECT_EQ(s[0].horizon_s, 2.5);
  EXPECT_EQ(s[0].windows, 1u);
  EXPECT_EQ(s[0].held, 0u);
  EXPECT_NEAR(s[0].shares.bias + s[0].shares.variance + s[0].shares.covariance, 1.0, 1e-12);
}

TEST(OpenLoopScores, SeriesFollowOneAnotherWithAGapBetween) {
  const OpenLoopForecast f = forecast({1.0, 2.0}, {1.0, 2.0}, 0.1, 0.0);
  const OpenLoopState s = scores({f, f}).at(0);
  EXPECT_THAT(s.time, ElementsAre(110.0, 111.0, 111.0, 110.0, 111.0, 111.0));
  EXPECT_TRUE(std::isnan(s.measured[2]));
  EXPECT_TRUE(std::isnan(s.sigma[0])) << "there the start is estimated";
  EXPECT_EQ(s.sigma[1], 0.1);
}

TEST(OpenLoopScores, MeasuresAreInTheUnitShown) {
  const double sigma = 0.1 * kDegree;
  const OpenLoopState s = scores({forecast({0.0, 0.0, kDegree}, {0.0, 0.0, 3.0 * kDegree}, sigma, 1.0)}, "rad").at(0);
  EXPECT_EQ(s.unit, "deg");
  EXPECT_NEAR(s.fit.rmse, std::sqrt(2.0), 1e-12);
}

TEST(OpenLoopScores, MedianHorizonAndWindowsHeldToTheirEnd) {
  const auto with = [](double horizon, bool diverged = false) {
    OpenLoopForecast f = forecast({1.0, 1.0, 2.0, 3.0}, {1.0, 1.0, 2.0, 3.0}, 0.1, horizon);
    f.window.diverged = diverged;
    return f;
  };
  const OpenLoopState s = scores({with(2.0), with(0.5), with(2.0, true)}).at(0);
  EXPECT_EQ(s.windows, 3u);
  EXPECT_EQ(s.held, 1u) << "one left its band, one diverged";
  EXPECT_EQ(s.horizon_s, 2.0);
}

TEST(OpenLoopScores, OutputsWithoutMeasurementsAndOtherGroupsAreLeftOut) {
  EXPECT_TRUE(scores({forecast({kNaN, kNaN, kNaN}, {1.0, 1.0, 1.0}, 0.1, 1.0)}).empty());
  OpenLoopForecast other = forecast({1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}, 0.1, 1.0);
  other.window.group = "climbs";
  EXPECT_TRUE(scores({other}).empty());
}

TEST(OpenLoopScores, WindowsAreCountedAndTheirForecastsAddUp) {
  OpenLoop open_loop;
  OpenLoopForecast f = forecast({1.0, 1.0, 1.0, 1.0}, {1.0, 1.0, 1.0, 1.0}, 0.1, 1.0);
  f.window.diverged = true;
  const std::vector<OpenLoopForecast> all{f, forecast({1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}, 0.1, 1.0)};
  add_windows(all, open_loop);
  EXPECT_EQ(open_loop.windows.size(), 2u);
  EXPECT_DOUBLE_EQ(open_loop.forecast_s, 3.0);
  EXPECT_EQ(diverged_windows(open_loop), 1u);
}

}  // namespace
}  // namespace veridyn::estimation
