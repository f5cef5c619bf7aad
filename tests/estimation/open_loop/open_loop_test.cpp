#include "veridyn/estimation/open_loop/open_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::estimation {
namespace {

OpenLoopTimes read(const std::string& keys) {
  const Study study = Study::parse("[validate]\n" + keys, "s.toml");
  return OpenLoopTimes::keys().read(study.root().table("validate"));
}

TEST(OpenLoopTimes, HaveUnitsAndMakeSense) {
  EXPECT_EQ(read("").duration_s, 0.0);
  EXPECT_EQ(read("open_loop = \"2 min\"\nopen_loop_start = 3").duration_s, 120.0);
  EXPECT_EQ(read("open_loop_start = 3").start_s, 3.0) << "nothing is asked for: nothing to contradict";
  EXPECT_THROW((void)read("open_loop = 2"), InputError) << "as long as its start";
  EXPECT_THROW((void)read("open_loop = \"2 m\""), InputError);
}

TEST(OpenLoopResult, KnowsItsGroupsAndGoesIntoTheEstimate) {
  OpenLoop open_loop;
  open_loop.states.push_back({.name = "alpha", .unit = "deg", .group = "longitudinal"});
  open_loop.states.push_back({.name = "q", .unit = "deg/s", .group = "longitudinal"});
  open_loop.states.push_back({.name = "p", .unit = "deg/s", .group = "lateral"});
  open_loop.states[0].fit = {.mae = 0.1, .rmse = 0.2, .r2 = 0.9, .theil = 0.05, .count = 7};
  open_loop.states[0].shares = {0.5, 0.3, 0.2};
  open_loop.states[0].inside = 0.94;
  open_loop.states[0].horizon_s = 12.0;
  EXPECT_THAT(open_loop.groups(), ::testing::ElementsAre("longitudinal", "lateral"));
  Estimate estimate;
  add_open_loop(open_loop, estimate);
  EXPECT_EQ(estimate.validation.at("open_loop.alpha").rmse, 0.2);
  EXPECT_EQ(estimate.validation.at("open_loop.alpha").unit, "deg");
  EXPECT_EQ(estimate.fit.at("open_loop.alpha.theil_variance"), 0.3);
  EXPECT_EQ(estimate.fit.at("open_loop.alpha.horizon_s"), 12.0);
  EXPECT_EQ(estimate.validation.size(), 3u);
}

TEST(OpenLoopResult, ShowsAnglesInDegreesAndTheRestInSi) {
  EXPECT_EQ(shown_unit("rad/s"), "deg/s");
  EXPECT_EQ(shown_unit("m/s^2"), "m/s^2");
  EXPECT_NEAR(shown_factor("rad"), 180.0 / std::numbers::pi, 1e-12);
  const OpenLoopState rate{.name = "q", .unit = "deg/s"};
  EXPECT_EQ(si_unit(rate), "rad/s");
  EXPECT_NEAR(shown_factor(rate), 180.0 / std::numbers::pi, 1e-12);
}

}  // namespace
}  // namespace veridyn::estimation
