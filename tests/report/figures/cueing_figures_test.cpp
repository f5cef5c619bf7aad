#include "veridyn/report/figures/cueing_figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/cueing_by_hand.hpp"
#include "tests/report/shown.hpp"

namespace veridyn::report {
namespace {

using cueing::Cue;
using cueing::PlatformAxis;
using testing::ElementsAre;
using testing::Pointwise;

TEST(CueingUnits, AreThoseOfADriver) {
  EXPECT_EQ(shown(Cue::kSurge, 2.5), 2.5);
  EXPECT_STREQ(shown_unit(Cue::kHeave), "m/s^2");
  EXPECT_NEAR(shown(Cue::kYaw, kPi), 180.0, 1e-12);
  EXPECT_STREQ(shown_unit(Cue::kRoll), "deg/s");
  EXPECT_NEAR(shown(PlatformAxis::kHeave, 0.1), 100.0, 1e-12);
  EXPECT_STREQ(shown_unit(PlatformAxis::kSway), "mm");
  EXPECT_NEAR(shown(PlatformAxis::kPitch, kPi / 2.0), 90.0, 1e-12);
  EXPECT_STREQ(shown_unit(PlatformAxis::kYaw), "deg");
}

TEST(IsMoved, IsWhatIsFeltAboveItsThresholdInEitherDirection) {
  const cueing::CueingResult result = test::cueing_by_hand({{"a", 0.5}});
  EXPECT_TRUE(is_moved(result, Cue::kSurge)) << "backwards";
  EXPECT_TRUE(is_moved(result, Cue::kRoll));
  EXPECT_FALSE(is_moved(result, Cue::kSway)) << "half the threshold";
}

TEST(CorrelationFigure, HasARowForEachCueThatIsFeltAndAnIntervalForEachAlgorithm) {
  cueing::CueingResult result = test::cueing_by_hand({{"tilt", 0.5}, {"optimal", 0.75}});
  result.algorithms[1].score.cues[Cue::kSurge].pearson = {.value = 0.75, .low = 0.6, .high = 0.8};
  const IntervalPlot plot = correlation_figure(result);
  check({.sections = {{.blocks = {plot}}}});
  EXPECT_THAT(plot.methods, ElementsAre("tilt", "optimal"));
  ASSERT_EQ(plot.rows.size(), 2U);
  EXPECT_EQ(plot.rows[0].name, "surge");
  EXPECT_EQ(plot.rows[1].name, "roll");
  EXPECT_EQ(plot.rows[0].estimates[0].value, 0.5);
  EXPECT_EQ(plot.rows[0].estimates[1].low, 0.6);
  EXPECT_EQ(plot.rows[0].estimates[1].high, 0.8);
}

TEST(FeltHistories, ShowForcesInSiAndTurnsInDegrees) {
  const TimeSeries figure = felt_histories(test::cueing_by_hand({{"tilt", 0.5}, {"optimal", 0.75}}));
  check({.sections = {{.blocks = {figure}}}});
  ASSERT_THAT(test::labels_of(figure), ElementsAre("surge", "roll"));
  EXPECT_THAT(test::lines_of(figure.panels[0]), ElementsAre("vehicle", "tilt", "optimal"));
  EXPECT_EQ(figure.panels[0].lines[0].role, Role::kMeasured);
  EXPECT_THAT(figure.panels[0].lines[0].y, ElementsAre(0.0, -2.0, 0.0));
  EXPECT_THAT(figure.panels[1].lines[1].y, Pointwise(testing::DoubleNear(1e-12), {0.0, 3.0, 0.0}));
  EXPECT_EQ(figure.panels[1].unit, "deg/s");
}

TEST(PlatformHistories, ShowTheLimitsOfAnAxisOnceMoreThanHalfOfItIsUsed) {
  cueing::CueingStudy study;
  study.platform = cueing::built_in_platform("three_axis");
  cueing::CueingResult result = test::cueing_by_hand({{"tilt", 0.5}});
  set_axis(result.algorithms[0].run.steps[1].reached, PlatformAxis::kHeave, {.position = 0.08});
  result.algorithms[0].score.axes[PlatformAxis::kHeave].used = 0.8;
  result.algorithms[0].score.axes[PlatformAxis::kRoll].used = 0.5;
  const TimeSeries figure = platform_histories(study, result);
  check({.sections = {{.blocks = {figure}}}});
  ASSERT_THAT(test::labels_of(figure), ElementsAre("heave", "roll", "pitch"));
  EXPECT_THAT(test::lines_of(figure.panels[0]), ElementsAre("tilt", "upper limit", "lower limit"));
  EXPECT_NEAR(figure.panels[0].lines[0].y[1], 80.0, 1e-9) << "mm";
  EXPECT_NEAR(figure.panels[0].lines[1].y[0], 100.0, 1e-9);
  EXPECT_NEAR(figure.panels[0].lines[2].y[0], -100.0, 1e-9);
  EXPECT_THAT(test::lines_of(figure.panels[1]), ElementsAre("tilt")) << "half and not more";
}

TEST(KnobFigure, LeavesOutKnobsWithoutEffectAndFactorsThatTheyMayNotTake) {
  cueing::AlgorithmResult a = test::algorithm_by_hand("tilt", 0.5);
  cueing::KnobEffect strong;
  strong.knob.name = "onset";
  strong.cue = Cue::kPitch;
  strong.factors = {0.5, 1.0, 1.0};  // twice is not allowed
  strong.difference = 2.0;
  strong.time = {0.0, 1.0};
  strong.vehicle = {0.0, kPi};
  strong.platform = {{{0.0, 0.1}, {0.0, 0.2}, {0.0, 0.2}}};
  cueing::KnobEffect none = strong;
  none.knob.name = "idle";
  none.difference = 0.0;
  a.effects = {strong, none};
  const TimeSeries figure = knob_figure(a);
  check({.sections = {{.blocks = {figure}}}});
  EXPECT_EQ(figure.title, "Knobs of tilt");
  ASSERT_THAT(test::labels_of(figure), ElementsAre("onset: pitch"));
  EXPECT_THAT(test::lines_of(figure.panels[0]), ElementsAre("vehicle", "half", "as set"));
  EXPECT_NEAR(figure.panels[0].lines[0].y[1], 180.0, 1e-9);
}

}  // namespace
}  // namespace veridyn::report
