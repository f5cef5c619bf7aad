#include "veridyn/report/parts/cueing_tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/report/cueing_by_hand.hpp"
#include "tests/report/shown.hpp"

namespace veridyn::report {
namespace {

using cueing::Cue;
using cueing::FalseCue;
using cueing::PlatformAxis;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(BestOf, IsWhoseCorrelationIsLargestAndNeverOneWithoutAny) {
  const cueing::CueingResult result = test::cueing_by_hand({{"still", kNaN}, {"wrong", -0.5}, {"worse", -0.75}});
  EXPECT_LT(correlation(result.algorithms[0], Cue::kSurge), -1.0);
  EXPECT_EQ(correlation(result.algorithms[1], Cue::kSurge), -0.5);
  EXPECT_EQ(best_of(result, Cue::kSurge).run.algorithm, "wrong");
}

TEST(ScoreTable, ShowsIntervalsWhereThereAreAnyAndDashesWhereThereIsNoFigure) {
  cueing::CueingResult result = test::cueing_by_hand({{"tilt", 0.5}});
  cueing::CueScore& roll = result.algorithms[0].score.cues[Cue::kRoll];
  roll.pearson = {.value = 0.825, .low = 0.7, .high = 0.9};
  roll.rmse = {.value = 2.0 * kDegree, .low = kNaN, .high = kNaN};
  roll.above = {.value = 0.25, .low = 0.125, .high = 0.5};
  roll.lag = roll.at_lag = roll.physical_pearson = {.value = kNaN, .low = kNaN, .high = kNaN};
  const Table table = score_table(result, Cue::kRoll);
  check({.sections = {{.blocks = {table}}}});
  EXPECT_EQ(table.title, "Roll");
  EXPECT_EQ(table.columns[4].unit, "deg/s");
  EXPECT_EQ(table.columns[5].name, "off > 3") << "the threshold in deg/s";
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_THAT(test::shown_row(table, 0),
              ElementsAre("tilt", "0.82 (0.70\u00a0to\u00a00.90)", "-", "-", "2.00", "25 (12\u00a0to\u00a050)", "-"));
}

TEST(PerceivedTable, ComparesWithTheLeastThatIsPossible) {
  cueing::CueingResult result = test::cueing_by_hand({{"tilt", 0.5}});
  result.algorithms[0].score.pairs = {{{.value = 3.0, .low = kNaN, .high = kNaN},    // sway and roll
                                       {.value = 5.0, .low = kNaN, .high = kNaN}}};  // surge and pitch
  const Table alone = perceived_table(result);
  ASSERT_EQ(alone.rows.size(), 1U) << "no bound was computed";
  EXPECT_THAT(test::shown_row(alone, 0), ElementsAre("tilt", "5.00", "–", "3.00", "–"));
  cueing::LeastError sway, surge;
  sway.error = 2.0;
  sway.still = 4.0;
  surge.error = 4.0;
  surge.still = 10.0;
  result.least = {sway, surge};
  const Table table = perceived_table(result);
  check({.sections = {{.blocks = {table}}}});
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("tilt", "5.00", "1.25", "3.00", "1.50"));
  EXPECT_THAT(test::shown_row(table, 1), ElementsAre("a platform that stands", "10.00", "2.50", "4.00", "2.00"));
  EXPECT_THAT(test::shown_row(table, 2), ElementsAre("least", "4.00", "1.00", "2.00", "1.00"));
}

/// Statistics of a minute in which the platform does `gain` of what the vehicle does, and `noise` of something else.
cueing::BlockStatistics statistics_of(double gain, double noise) {
  std::vector<double> x, y;
  for (int k = 0; k < 3000; ++k) {
    const double t = 0.02 * k;
    x.push_back(std::sin(1.3 * t) + 0.3 * std::sin(0.37 * t));
    y.push_back(gain * x.back() + noise * std::sin(5.1 * t));
  }
  return {x, y, 0.02, 0.1};
}

cueing::CueingResult three_blocks_apart() {
  cueing::CueingResult result = test::cueing_by_hand({{"tilt", 0.7}, {"optimal", 0.99}, {"twin", 0.99}});
  result.algorithms[0].score.felt_blocks[Cue::kSurge] = statistics_of(1.0, 0.8);
  result.algorithms[1].score.felt_blocks[Cue::kSurge] = statistics_of(1.0, 0.1);
  result.algorithms[2].score.felt_blocks[Cue::kSurge] = statistics_of(1.0, 0.1);
  return result;
}

TEST(Differences, AreThoseThatTheIntervalsLeaveOutZeroOf) {
  const List list = differences(three_blocks_apart());
  ASSERT_EQ(list.items.size(), 1U) << "of sway nothing is felt";
  EXPECT_THAT(list.items[0], HasSubstr("Surge: optimal correlates best; better than tilt by 0."));
  EXPECT_THAT(list.items[0], HasSubstr("no different beyond the intervals from twin."));
}

TEST(Differences, SayNothingOfAShortDrive) {
  EXPECT_THAT(differences(test::cueing_by_hand({{"tilt", 0.5}, {"optimal", 0.75}})).items, IsEmpty());
}

TEST(AgainstFirst, HasEachOtherAlgorithmInTheForcesThatAreFelt) {
  const cueing::CueingResult result = three_blocks_apart();
  const Table table = against_first(result);
  check({.sections = {{.blocks = {table}}}});
  EXPECT_EQ(table.title, "Against tilt");
  ASSERT_EQ(table.columns.size(), 3U) << "surge alone; roll is no force";
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(test::shown_in(table, table.rows[0], "algorithm"), "optimal");
  const auto difference = [&](std::size_t row) {
    return test::shown_in(table, table.rows[row], "correlation", "surge");
  };
  EXPECT_THAT(difference(0), HasSubstr("0."));
  EXPECT_EQ(difference(0), difference(1)) << "twins";
}

TEST(WorkspaceTable, ShowsWhatEachAxisUsedInItsUnit) {
  cueing::CueingStudy study;
  study.platform = cueing::built_in_platform("three_axis");
  cueing::CueingResult result = test::cueing_by_hand({{"tilt", 0.5}});
  result.algorithms[0].score.axes[PlatformAxis::kHeave] = {
      .lowest = -0.05, .highest = 0.08, .used = 0.8, .limited = 0.021, .rate = 0.5, .rms_jerk = 1.23456};
  result.algorithms[0].score.axes[PlatformAxis::kRoll] = {.lowest = -1.0 * kDegree, .highest = 2.0 * kDegree};
  const Table table = workspace_table(study, result);
  check({.sections = {{.blocks = {table}}}});
  ASSERT_EQ(table.rows.size(), 3U) << "heave, roll, pitch";
  EXPECT_THAT(test::shown_row(table, 0),
              ElementsAre("heave\u00a0[mm]", "tilt", "−50.0", "80.0", "80", "2.1", "50", "1230"));
  EXPECT_THAT(test::shown_row(table, 1),
              ElementsAre("roll\u00a0[deg]", "tilt", "−1.00", "2.00", "0.0", "0.0", "0.0", "0"));
}

cueing::CueingResult with_false_cues() {
  cueing::CueingResult result = test::cueing_by_hand({{"tilt", 0.5}});
  // Thresholds are 0.1 m/s^2 and 3 deg/s.
  result.algorithms[0].score.false_cues = {
      {.cue = Cue::kSurge, .kind = FalseCue::Kind::kMissing, .begin = 1.0, .end = 1.5, .size = 0.3},
      {.cue = Cue::kRoll, .kind = FalseCue::Kind::kWrongSign, .begin = 4.0, .end = 6.0, .size = 15.0 * kDegree},
      {.cue = Cue::kSurge, .kind = FalseCue::Kind::kMissing, .begin = 8.0, .end = 8.25, .size = 0.2}};
  result.algorithms[0].score.felt_return = 0.034;
  return result;
}

TEST(FalseCueTable, HasTheLargestOverTheirThresholdsFirst) {
  const Table table = false_cue_table(with_false_cues());
  check({.sections = {{.blocks = {table}}}});
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("tilt", "4.00", "2.00", "roll", "wrong sign", "5.0"));
  EXPECT_THAT(test::shown_row(table, 1), ElementsAre("tilt", "1.00", "0.50", "surge", "missing", "3.0"));
}

TEST(FalseCueTable, HasAboutAScreenOfThem) {
  const auto rows_of = [](int algorithms) {
    cueing::CueingResult result;
    for (int i = 0; i < algorithms; ++i) {
      cueing::CueingResult one = with_false_cues();
      std::vector<FalseCue>& all = one.algorithms[0].score.false_cues;
      all.resize(100, FalseCue(all.front()));
      result.algorithms.push_back(std::move(one.algorithms[0]));
    }
    return false_cue_table(result).rows.size();
  };
  EXPECT_EQ(rows_of(1), 30U);
  EXPECT_EQ(rows_of(2), 30U);
  EXPECT_EQ(rows_of(15), 45U) << "three of each at least";
}

TEST(FalseCueCounts, CountEachKindAndAddTheirTime) {
  const Table table = false_cue_counts(with_false_cues());
  check({.sections = {{.blocks = {table}}}});
  // 0.5 s, 2 s and 0.25 s.
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("tilt", "1", "0", "2", "2.8", "3.4"));
}

TEST(TuningSection, ShowsTheKnobsThatWereTurned) {
  cueing::CueingResult result = test::cueing_by_hand({{"tilt", 0.5}, {"optimal", 0.75}});
  cueing::Tuning tuning;
  tuning.cost_before = 0.8125;
  tuning.cost_after = 0.5;
  tuning.evaluations = 150;
  result.algorithms[1].tuning = std::move(tuning);
  const Section none = tuning_section(result);
  check({.sections = {none}});
  const Table costs = test::table_of(none.blocks, "What tuning gained");
  ASSERT_EQ(costs.rows.size(), 1U) << "tilt was not tuned";
  EXPECT_THAT(test::shown_row(costs, 0), ElementsAre("optimal", "0.812", "0.500", "150"));
  EXPECT_THAT(test::texts_of(none.blocks), ElementsAre(HasSubstr("No knob was turned")));
  result.algorithms[1].tuning->knobs = {{.name = "onset", .unit = "rad/s", .before = {0.8, 1.0}, .after = {0.9, 1.25}},
                                        {.name = "gain", .unit = "1", .before = {0.5}, .after = {0.75}}};
  const Section turned = tuning_section(result);
  check({.sections = {turned}});
  const Table knobs = test::table_of(turned.blocks, "Knobs that were turned");
  EXPECT_THAT(test::shown_row(knobs, 0), ElementsAre("optimal", "onset", "0.8, 1", "0.9, 1.25", "rad/s"));
  EXPECT_THAT(test::shown_row(knobs, 1), ElementsAre("optimal", "gain", "0.5", "0.75", ""));
}

}  // namespace
}  // namespace veridyn::report
