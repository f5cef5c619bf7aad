#include "veridyn/report/sensitivity_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::report {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

muscle::SensitivityStudy study_of_an_arm() {
  muscle::SensitivityStudy study;
  study.title = "which task";
  study.subject.model_name = "arm";
  study.subject.system = std::make_unique<muscle::MusculoskeletalSystem>(muscle::load_model("arm").model());
  study.seed = 5;
  study.options.sampling.range = 0.05;
  return study;
}

/// Two muscles and three tasks: curl and press are chosen, wave is kept out by a wrap's band.
muscle::MuscleSensitivity two_of_three_tasks() {
  muscle::MuscleSensitivity s;
  s.muscles = {"biceps", "triceps"};
  s.tasks = {{.name = "curl"}, {.name = "press"}, {.name = "wave"}};
  s.tasks[1].failed = 2;
  s.tasks[2].obstacle = "reserves are too large";
  s.tasks[2].wrap_bands = {"in the band of ELB"};
  s.sampling.samples = 64;
  s.sampling.simulations = 384;
  s.sampling.mean.resize(2, 3);
  s.sampling.mean << 0.02, 0.01, kNaN, 0.001, 0.05, 0.002;
  s.cover.chosen = {{.tasks = {0, 1}, .excited = 2, .weakest = 0.8, .mean = 0.9, .weakest_muscle = 1}};
  s.cover.excites = {{0}, {1}, {}};
  return s;
}

std::vector<muscle::PreparedTask> prepared_tasks() {
  std::vector<muscle::PreparedTask> tasks(3);
  tasks[0].tracking_error = 0.5 * kDegree;
  tasks[0].reserve_share = 0.013;
  return tasks;
}

Document report_of(const muscle::MuscleSensitivity& s) {
  Document document = sensitivity_report(study_of_an_arm(), prepared_tasks(), s, "veridyn test");
  check(document);
  return document;
}

TEST(SensitivityReport, SaysWhichTasksExciteEveryMuscle) {
  const Document document = report_of(two_of_three_tasks());
  EXPECT_EQ(document.verdict.level, Level::kGood);
  EXPECT_EQ(document.verdict.headline, "Tasks \"curl\", \"press\" excite 2 of 2 muscles.");
  EXPECT_THAT(document.verdict.lines.front(), HasSubstr("triceps is excited least: 80 %"));
  EXPECT_THAT(document.verdict.lines, Not(Contains(HasSubstr("Runner-up"))));
  EXPECT_EQ(test::fact_of(document.facts, "Samples"), "64 a muscle");
  EXPECT_EQ(test::fact_of(document.facts, "Seed"), "5");
  EXPECT_THAT(test::titles_of(document), Not(Contains("Indices of the chosen tasks"))) << "none were computed";
}

TEST(SensitivityReport, CautionsWhereAMuscleIsLeftOrABandHadToBeAllowed) {
  muscle::MuscleSensitivity s = two_of_three_tasks();
  s.bands_allowed = true;
  s.cover.runner_up = {{.tasks = {0, 2}, .excited = 1, .weakest = 0.1, .weakest_muscle = 1}};
  const Document care = report_of(s);
  EXPECT_EQ(care.verdict.level, Level::kCaution);
  EXPECT_EQ(care.verdict.word, "With care");
  EXPECT_THAT(care.verdict.lines, Contains(HasSubstr("Runner-up: tasks \"curl\", \"wave\"")));
  s.cover.chosen->excited = 1;
  EXPECT_EQ(report_of(s).verdict.word, "Not every muscle");
}

TEST(SensitivityReport, SaysThatNoTaskCanBeChosen) {
  muscle::MuscleSensitivity s = two_of_three_tasks();
  s.cover.chosen.reset();
  s.warnings = {"every task fails"};
  const Document document = report_of(s);
  EXPECT_EQ(document.verdict.level, Level::kBad);
  EXPECT_EQ(document.verdict.headline, "No task can be chosen.");
  EXPECT_EQ(test::titles_of(document).front(), "Warnings");
}

TEST(SensitivityReport, MapsEachMuscleInEachTaskInPerCent) {
  const Document document = report_of(two_of_three_tasks());
  const Section& section = test::section_of(document, "Which muscle moves which task");
  const Matrix map = test::blocks_of<Matrix>(section.blocks).at(0);
  EXPECT_THAT(map.row_names, ElementsAre("chosen: curl", "chosen: press", "wave"));
  EXPECT_THAT(map.column_names, ElementsAre("biceps", "triceps"));
  EXPECT_NEAR(map.values[0][0], 2.0, 1e-12);
  EXPECT_NEAR(map.values[1][1], 5.0, 1e-12);
  EXPECT_NEAR(map.high, 5.0, 1e-12) << "the full colour is the largest that is a number";
  EXPECT_THAT(map.caption, HasSubstr("within 5 % of the model's: mean over 64 points"));
}

TEST(SensitivityReport, SaysOfEachTaskWhyItIsNotChosen) {
  const Document document = report_of(two_of_three_tasks());
  const Table table = test::table_of(test::section_of(document, "Tasks").blocks, "Tasks");
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("curl", "chosen", "biceps", "0.50", "1.3", "0", ""));
  EXPECT_EQ(test::shown_in(table, table.rows[1], "Failed"), "2");
  EXPECT_EQ(test::shown_in(table, table.rows[2], "Why not"), "reserves are too large; in the band of ELB");
  EXPECT_EQ(table.rows[2].status, Status::kBad);
}

TEST(SensitivityReport, ShowsIndicesOfEitherKind) {
  muscle::MuscleSensitivity s = two_of_three_tasks();
  s.indices.inputs = {"biceps F0"};
  muscle::ResultIndices shares, screening;
  shares.result = "curl";
  shares.variance.inputs = {{.first = 0.5, .total = 0.6}};
  shares.variance.evaluations = 30;
  screening.result = "press";
  screening.morris = {{.mean = 0.01, .absolute = 0.02, .sd = 0.0}};
  s.indices.results = {shares, screening};
  const Document document = report_of(s);
  const Section& section = test::section_of(document, "Indices of the chosen tasks");
  EXPECT_EQ(test::blocks_of<IntervalPlot>(section.blocks).at(0).title, "curl");
  const Table table = test::table_of(section.blocks, "press");
  EXPECT_EQ(test::shown_in(table, table.rows[0], "mu*"), "2.00") << "per cent";
}

}  // namespace
}  // namespace veridyn::report
