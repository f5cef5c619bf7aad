#include "veridyn/report/muscle_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/lifted_arm.hpp"
#include "tests/report/shown.hpp"
#include "veridyn/report/document/html.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(MuscleReport, HasPosesCurvesAndATableOfTheMuscles) {
  const test::SimulatedArm lift =
      test::simulated_arm(test::kLift, test::kLoad + "[subject.parameters]\nbrachialis.max_isometric_force = 900\n");
  const Document document = muscle_report(lift.study, lift.result, "veridyn test");
  check(document);
  EXPECT_EQ(document.verdict.level, Level::kGood);
  EXPECT_THAT(test::titles_of(document), ElementsAre("Motion", "Muscles", "Notes", "Credits of the model"));
  EXPECT_EQ(test::blocks_of<XYPlot>(test::section_of(document, "Motion").blocks).size(), 2u);
  const Table table = test::blocks_of<Table>(test::section_of(document, "Muscles").blocks).at(0);
  EXPECT_EQ(table.rows.size(), 6u);
  EXPECT_EQ(test::row_of(table, "brachialis").status, Status::kCaution) << "the study sets its parameter";
  EXPECT_EQ(test::row_of(table, "triceps_long").status, Status::kNone);
  EXPECT_THAT(to_html(document), HasSubstr("biceps_long"));
}

TEST(MuscleReport, SaysThatASimulationDidNotFinish) {
  const test::SimulatedArm failed = test::simulated_arm(
      "duration = 1\naccuracy = 0.1\n[motion.start_speed]\nelbow_flexion = 1e6\n", "locked = [\"shoulder_flexion\"]\n");
  ASSERT_FALSE(failed.result.usable());
  const Document document = muscle_report(failed.study, failed.result, "veridyn test");
  check(document);
  EXPECT_EQ(document.verdict.level, Level::kBad);
  EXPECT_EQ(document.verdict.word, "Not finished");
  EXPECT_THAT(document.verdict.headline, HasSubstr("at "));
}

TEST(MuscleReport, WarnsWhereMusclesCannotDoIt) {
  const test::SimulatedArm weak = test::simulated_arm("reserve_force = 0\n" + test::kLift,
                                                      test::kLoad +
                                                          "[subject.parameters]\nbrachialis.max_isometric_force = 5\n"
                                                          "biceps_long.max_isometric_force = 5\n"
                                                          "biceps_short.max_isometric_force = 5\n");
  const Document document = muscle_report(weak.study, weak.result, "veridyn test");
  EXPECT_EQ(document.verdict.level, Level::kCaution);
  ASSERT_FALSE(document.sections.empty());
  EXPECT_EQ(document.sections[0].title, "Warnings");
}

}  // namespace
}  // namespace veridyn::report
