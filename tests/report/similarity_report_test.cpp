#include "veridyn/report/similarity_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/scaled_car.hpp"
#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(SimilarityReport, SaysThatATwinIsSimilarButForGravity) {
  const test::ScaledCar twin = test::scaled_twin();
  const Document document = similarity_report(twin.study, twin.analysis, "veridyn test");
  check(document);
  EXPECT_EQ(document.verdict.level, Level::kCaution);
  EXPECT_EQ(document.verdict.word, "Similar but for gravity");
  EXPECT_EQ(test::fact_of(document.facts, "Model"), "exactly similar");
  EXPECT_EQ(test::fact_of(document.facts, "Length ratio"), "0.2");
  EXPECT_THAT(test::titles_of(document),
              ElementsAre("Pi groups", "Scaled vehicle", "Differences", "Path", "Motion", "Tyres", "Body and wheels"));
}

TEST(SimilarityReport, JudgesAGivenModelByItsGroups) {
  test::ScaledCar car = test::scaled_twin();
  vehicle::SimilarityReport& judged = car.analysis.given_report.emplace(car.analysis.twin_report);
  car.study.given = car.study.simulation.vehicle;
  car.study.given->name = "kit";
  car.study.given_subject = car.analysis.scaled.model;
  judged.groups.at(0).mismatch_percent = 4.25;
  const Document document = similarity_report(car.study, car.analysis, "veridyn test");
  check(document);
  EXPECT_EQ(document.verdict.level, Level::kBad);
  EXPECT_EQ(document.verdict.word, "Not similar");
  EXPECT_EQ(test::fact_of(document.facts, "Model"), "kit");
  const Table groups = test::table_of(document.sections[0].blocks, "Groups of the given model");
  EXPECT_EQ(test::shown_in(groups, groups.rows[0], "mismatch"), "+4.25 %");
  EXPECT_EQ(test::shown_in(groups, groups.rows[0], "what suffers"), judged.groups[0].affects);
  EXPECT_EQ(groups.rows[0].status, Status::kBad);
  EXPECT_EQ(test::shown_in(groups, groups.rows[1], "mismatch"), "0 %");
  EXPECT_EQ(groups.rows[1].status, Status::kNone);
  const Table numbers = test::table_of(test::section_of(document, "Scaled vehicle").blocks, "Scaled parameters");
  const Row& mass = test::row_of(numbers, "mass");
  EXPECT_EQ(test::shown_in(numbers, mass, "kit"), test::shown_in(numbers, mass, "exactly similar"));
}

TEST(SimilarityReport, GoodIsWhatKeepsGravityToo) {
  test::ScaledCar car = test::scaled_twin();
  car.analysis.twin_report.gravity.mismatch_percent = 0.0;
  EXPECT_EQ(similarity_report(car.study, car.analysis, "").verdict.level, Level::kGood);
}

TEST(SimilarityReport, ScalesMassAndSpeedAsAsked) {
  const test::ScaledCar twin = test::scaled_twin();
  const Document document = similarity_report(twin.study, twin.analysis, "veridyn test");
  const Table table = test::table_of(test::section_of(document, "Scaled vehicle").blocks, "Scaled parameters");
  EXPECT_EQ(test::shown_in(table, test::row_of(table, "mass"), "exactly similar"), "8.80000");
  const Row& speed = test::row_of(table, "speed");
  EXPECT_EQ(test::shown_in(table, speed, "exactly similar"), "4.00000");
  EXPECT_EQ(test::shown_in(table, speed, "factor"), "0.200000");
  EXPECT_EQ(test::shown_in(table, speed, "unit"), "m/s");
}

TEST(GroupSection, KeepsGravityApartAndWithCare) {
  const test::ScaledCar twin = test::scaled_twin();
  const Section section = group_section(twin.analysis);
  const Table gravity = test::table_of(section.blocks, "Gravity, separately");
  ASSERT_EQ(gravity.rows.size(), 1U);
  // g L / u^2 at a fifth of length and speed: five times.
  EXPECT_EQ(test::shown_in(gravity, gravity.rows[0], "mismatch"), "+400 %");
  EXPECT_EQ(gravity.rows[0].status, Status::kCaution);
  EXPECT_THAT(test::texts_of(section.blocks), testing::Not(IsEmpty())) << "what gravity changes";
}

TEST(GroupSection, SaysThatOnlyOneHasAQuantity) {
  test::ScaledCar car = test::scaled_twin();
  car.analysis.twin_report.groups.at(0).mismatch_percent = kInfinity;
  const Table groups = test::table_of(group_section(car.analysis).blocks, "Groups");
  EXPECT_EQ(test::shown_in(groups, groups.rows[0], "mismatch"), "only one has it");
  EXPECT_EQ(groups.rows[0].status, Status::kBad);
}

TEST(DifferenceSection, ComparesEveryDriveAndWarnsOfOneThatEndedEarly) {
  test::ScaledCar car = test::scaled_twin();
  const Section section = difference_section(car.analysis);
  EXPECT_THAT(test::blocks_of<List>(section.blocks), IsEmpty());
  const Table table = test::blocks_of<Table>(section.blocks).at(0);
  check({.sections = {section}});
  ASSERT_EQ(table.columns.size(), 1 + car.analysis.runs.size());
  const vehicle::MotionDifference& d = car.analysis.runs[1].differences.at(0);
  ASSERT_GT(d.range, 0.0);
  EXPECT_DOUBLE_EQ(*table.rows[0].cells[2].number, 100.0 * d.largest / d.range);
  car.analysis.runs[1].trajectory.end = vehicle::DriveEnd::kDiverged;
  car.analysis.runs[1].trajectory.end_time = 0.1;
  const std::vector<List> early = test::blocks_of<List>(difference_section(car.analysis).blocks);
  ASSERT_EQ(early.size(), 1U);
  EXPECT_EQ(early[0].tone, Tone::kWarning);
  EXPECT_THAT(early[0].items, ElementsAre(HasSubstr(car.analysis.runs[1].name)));
}

TEST(OverlaySections, LayTheModelOverThePrototype) {
  const test::ScaledCar twin = test::scaled_twin();
  const std::vector<Section> sections = overlay_sections(twin.study, twin.analysis);
  const XYPlot path = test::blocks_of<XYPlot>(sections.at(0).blocks).at(0);
  ASSERT_EQ(path.series.size(), 2U);
  EXPECT_EQ(path.series[1].name, "prototype");
  EXPECT_EQ(path.series[1].role, Role::kReference);
  // Static loads do not scale with the forces: what the drive adds begins at nothing for both.
  const TimeSeries ride = test::blocks_of<TimeSeries>(sections.at(3).blocks).at(0);
  ASSERT_THAT(test::labels_of(ride), Contains("normal force less static load"));
  for (const Panel& panel : ride.panels) {
    if (panel.label != "normal force less static load") continue;
    for (const Line& line : panel.lines) EXPECT_EQ(line.y.front(), 0.0) << line.name;
  }
}

}  // namespace
}  // namespace veridyn::report
