#include "veridyn/report/figures/aircraft_figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace veridyn::report {
namespace {

/// A quantity predicted on stretches of 8 s that begin at the given times.
aircraft::PredictedQuantity quantity(const std::string& name, const std::vector<double>& begins) {
  aircraft::PredictedQuantity result;
  result.name = name;
  result.unit = "m/s";
  for (const double begin : begins) {
    for (int k = 0; k <= 80; ++k) result.time.push_back(begin + 0.1 * k);
  }
  result.measured.assign(result.time.size(), 20.0);
  result.predicted.assign(result.time.size(), 21.0);
  return result;
}

TEST(ValidationFigures, ShowTheHeldOutStretchesSideBySide) {
  aircraft::Validation validation;
  validation.period_s = 5.0;
  validation.windows = 2;
  validation.quantities = {quantity("airspeed", {20.0, 290.0}), quantity("alpha", {20.0, 290.0}),
                           quantity("beta", {60.0, 100.0, 280.0})};
  ASSERT_TRUE(validation.available());
  const std::vector<TimeSeries> figures = validation_figures(validation);
  ASSERT_EQ(figures.size(), 2U);
  EXPECT_EQ(figures[0].panels.size(), 2U);
  EXPECT_EQ(figures[0].windows.size(), 2U);
  EXPECT_EQ(figures[1].panels.size(), 1U);
  EXPECT_EQ(figures[1].windows.size(), 3U);
  EXPECT_NEAR(figures[1].windows[2].from, 280.0, 1e-9);
  for (const TimeSeries& figure : figures) check({.sections = {{.blocks = {figure}}}});
}

}  // namespace
}  // namespace veridyn::report
