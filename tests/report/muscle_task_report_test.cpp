#include "veridyn/report/muscle_task_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::report {
namespace {

using estimation::ParameterStatus;
using muscle::MuscleAnalysis;
using muscle::TaskStudy;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TaskStudy study_of_a_person() {
  TaskStudy study;
  study.subject.title = "a person";
  study.subject.model_name = "arm";
  study.subject.system = std::make_unique<muscle::MusculoskeletalSystem>(muscle::load_model("arm").model());
  study.unknowns.resize(2);
  study.unknowns[0].name = "brachialis.max_isometric_force";
  study.unknowns[0].start = 987.0;
  study.unknowns[1].name = "flexors";
  study.unknowns[1].start = 1.0;
  study.person.emplace();
  return study;
}

/// One parameter that is identified and one that the prior holds, from one task; another one is held out.
MuscleAnalysis analysis_by_hand() {
  MuscleAnalysis a;
  a.estimate.method = "output error";
  a.estimate.verdict = "one of two is identified";
  a.estimate.parameters = {{.name = "brachialis.max_isometric_force",
                            .value = 1003.4,
                            .sigma = 12.0,
                            .low95 = 979.9,
                            .high95 = 1026.9,
                            .unit = "N",
                            .status = ParameterStatus::kIdentified},
                           {.name = "flexors", .value = 1.02, .sigma = 0.1, .status = ParameterStatus::kNotExcited}};
  a.truth = {{"brachialis.max_isometric_force", 1010.0}};
  a.result.learned = Eigen::Vector2d(0.95, 0.05);
  a.outputs = {{.name = "elbow_flexion", .unit = "rad"}};
  const auto task = [](const char* name, bool hold_out) {
    muscle::TaskOutcome t;
    t.name = name;
    t.hold_out = hold_out;
    t.time = {0.0, 0.5, 1.0};
    t.measured = Eigen::Vector3d(0.0, 0.5 * kPi, kPi);
    t.standard = Eigen::Vector3d(0.0, 0.4 * kPi, kPi);
    t.estimated = Eigen::Vector3d(0.0, 0.5 * kPi, kPi);
    t.before = {.rmse = 0.1 * kDegree, .nrmse = 0.05, .range = kPi, .moves = true};
    t.after = {.rmse = 0.02 * kDegree, .nrmse = 0.01, .range = kPi, .moves = true};
    t.reserve_share = 0.03;
    return t;
  };
  a.tasks = {task("curl", false), task("wave", true)};
  return a;
}

Document report_of(const TaskStudy& study, const MuscleAnalysis& a) {
  Document document = muscle_task_report(study, a, "veridyn test");
  check(document);
  return document;
}

TEST(MuscleTaskReport, ShowsEachParameterWithWhatTheTasksSayOfIt) {
  const Document document = report_of(study_of_a_person(), analysis_by_hand());
  EXPECT_EQ(document.title, "a person");
  EXPECT_EQ(test::fact_of(document.facts, "Estimated"), "one of two is identified");
  const std::vector<TimeSeries> lead = test::blocks_of<TimeSeries>(document.lead);
  ASSERT_EQ(lead.size(), 1U) << "of the task that was held out";
  EXPECT_EQ(lead.front().title, "wave (unseen)");
  EXPECT_EQ(test::fact_of(document.facts, "Recording"), "a simulated person");
  EXPECT_EQ(test::fact_of(document.facts, "Held out"), "1 tasks");
  const Table table = test::table_of(test::section_of(document, "Parameters").blocks, "Parameters");
  ASSERT_EQ(table.rows.size(), 2U);
  const Row& force = table.rows[0];
  EXPECT_EQ(test::shown_in(table, force, ""), "identified");
  EXPECT_EQ(test::shown_in(table, force, "standard"), "987");
  EXPECT_EQ(test::shown_in(table, force, "value"), "1003");
  EXPECT_EQ(test::shown_in(table, force, "truth"), "1010");
  EXPECT_EQ(test::shown_in(table, force, "to", "95 %"), "1027");
  EXPECT_EQ(test::shown_in(table, force, "unit"), "N");
  EXPECT_EQ(test::shown_in(table, force, "learned"), "95.0");
  EXPECT_EQ(test::shown_in(table, table.rows[1], ""), "not excited");
  EXPECT_EQ(test::shown_in(table, table.rows[1], "unit"), "");
  EXPECT_EQ(test::shown_in(table, table.rows[1], "truth"), "–");
}

TEST(MuscleTaskReport, LeavesOutWhatTheStudyDidNotAskFor) {
  TaskStudy study = study_of_a_person();
  EXPECT_THAT(test::titles_of(report_of(study, analysis_by_hand())),
              ElementsAre("Parameters", "Tasks before and after"));
  study.notes = {"a note"};
  EXPECT_EQ(test::titles_of(report_of(study, analysis_by_hand())).back(), "Notes");
  MuscleAnalysis a = analysis_by_hand();
  a.truth.clear();
  const Document document = report_of(study_of_a_person(), a);
  const Table table = test::table_of(test::section_of(document, "Parameters").blocks, "Parameters");
  for (const Column& column : table.columns) EXPECT_NE(column.name, "truth");
}

TEST(MuscleTaskReport, ShowsEachTaskBeforeAndAfter) {
  MuscleAnalysis a = analysis_by_hand();
  a.tasks[1].after = {.rmse = kNaN, .nrmse = kNaN};
  a.tasks[1].estimated.resize(0, 0);
  const Document document = report_of(study_of_a_person(), a);
  const Section& section = test::section_of(document, "Tasks before and after");
  const Table table = test::table_of(section.blocks, "Tasks");
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("curl", "trained", "5.00", "1.00", "0.100", "0.0200", "3.0"));
  EXPECT_EQ(test::shown_in(table, table.rows[1], "after", "NRMSE"), "-") << "the simulation could not finish";
  EXPECT_EQ(table.rows[1].status, Status::kBad);
  const std::vector<TimeSeries> unseen = test::blocks_of<TimeSeries>(document.lead);
  ASSERT_EQ(unseen.size(), 1U);
  EXPECT_THAT(test::lines_of(unseen[0].panels[0]), ElementsAre("measured", "standard model"));
  const std::vector<TimeSeries> figures = test::blocks_of<TimeSeries>(section.blocks);
  ASSERT_EQ(figures.size(), 1U) << "the unseen one is on the first screen";
  EXPECT_EQ(figures[0].title, "Tasks that the estimate is from");
  EXPECT_THAT(test::lines_of(figures[0].panels[0]), ElementsAre("measured", "standard model", "estimate"));
  EXPECT_NEAR(figures[0].panels[0].lines[0].y.back(), 180.0, 1e-9) << "deg";
}

TEST(MuscleTaskReport, BeginsWithTheUnseenTasksThatArePredictedWorst) {
  MuscleAnalysis a = analysis_by_hand();
  for (int k = 0; k < 6; ++k) {
    a.tasks.push_back(a.tasks[1]);
    a.tasks.back().name = std::string("task ") + static_cast<char>('a' + k);
    a.tasks.back().after.nrmse = k == 2 ? kNaN : 0.1 * k;
  }
  const std::vector<TimeSeries> lead = test::blocks_of<TimeSeries>(report_of(study_of_a_person(), a).lead);
  std::vector<std::string> titles;
  for (const TimeSeries& figure : lead) titles.push_back(figure.title);
  EXPECT_THAT(titles, ElementsAre("task c (unseen)", "task f (unseen)", "task e (unseen)", "task d (unseen)"));
}

TEST(MuscleTaskReport, ShowsNoMorePanelsThanOneCanSee) {
  MuscleAnalysis a = analysis_by_hand();
  a.tasks.resize(1);
  a.tasks.resize(20, a.tasks[0]);
  const Document document = report_of(study_of_a_person(), a);
  const Section& section = test::section_of(document, "Tasks before and after");
  EXPECT_EQ(test::blocks_of<TimeSeries>(section.blocks).at(0).panels.size(), 12U);
}

TEST(MuscleTaskReport, AdvisesTheBestThreeTasksAndSaysWhatTheyAreWorth) {
  MuscleAnalysis a = analysis_by_hand();
  a.advice.now = {.parameter = "flexors", .share = 0.2};
  for (const int number : {12, 29, 33, 8})
    a.advice.tasks.push_back({.number = number, .name = "task " + std::to_string(number), .then = {"flexors", 0.05}});
  a.advice.left_to_prior = {"triceps"};
  a.advice.left_out = {"task 1: outside the ranges"};
  const Document document = report_of(study_of_a_person(), a);
  const Section& section = test::section_of(document, "Which task next");
  const Table table = test::table_of(section.blocks, "Which task next");
  ASSERT_EQ(table.rows.size(), 3U);
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("task 12", "20.0", "5.00", "flexors"));
  EXPECT_THAT(test::texts_of(section.blocks),
              Contains(HasSubstr("Left to their priors, whichever task is added: triceps.")));
  EXPECT_THAT(test::texts_of(section.blocks), Contains("Not to be advised: task 1: outside the ranges."));
  a.advice = {};
  a.advice.withheld = "the estimate is rejected";
  const Document withheld = report_of(study_of_a_person(), a);
  EXPECT_THAT(test::texts_of(test::section_of(withheld, "Which task next").blocks),
              ElementsAre("No task is advised: the estimate is rejected."));
}

TEST(MuscleTaskReport, SaysWhichElectrodeIsWhose) {
  TaskStudy study = study_of_a_person();
  study.person.reset();
  study.outputs.resize(1);
  muscle::EmgSettings& emg = study.emg.emplace();
  emg.signals = {"TRI", "BIC"};
  emg.signal_of = {0, 0, 0, 1, 1, -1};
  MuscleAnalysis a = analysis_by_hand();
  a.outputs = {{.name = "elbow moment", .unit = "N m"}};
  a.moment_noise = Eigen::VectorXd::Constant(1, 0.123);
  a.emg_share = {0.2, 0.4};
  const Document document = report_of(study, a);
  EXPECT_EQ(test::fact_of(document.facts, "Recording"), "measured motion");
  EXPECT_EQ(test::fact_of(document.facts, "Noise of elbow moment"), "0.123 N m (found together with the EMG's error)");
  EXPECT_EQ(test::fact_of(document.facts, "Error of the EMG"), "30 % of the residual's variance");
  const Section& section = test::section_of(document, "Which EMG drives which muscle");
  const Table table = test::table_of(section.blocks, "EMG");
  EXPECT_THAT(test::shown_row(table, 1), ElementsAre("BIC", "biceps_long, biceps_short"));
  EXPECT_THAT(test::shown_row(table, 2), ElementsAre("at rest", "brachialis"));
}

TEST(MuscleTaskReport, SaysWhereEachSearchEnded) {
  MuscleAnalysis a = analysis_by_hand();
  a.result.searches = {{.rms_start = 9.0, .cost = 55.5, .steps = 12, .agrees = true, .message = "converged"},
                       {.rms_start = 4.0, .cost = 50.0, .steps = 8, .agrees = true, .message = "converged"},
                       {.rms_start = 4.0, .cost = 80.0, .steps = 8, .agrees = false, .message = "converged"},
                       {.rms_start = kNaN, .cost = kNaN, .steps = 0, .agrees = false, .message = "diverged"}};
  a.result.chosen = 1;
  a.result.null_directions = {"A against B"};
  const Document document = report_of(study_of_a_person(), a);
  EXPECT_EQ(test::fact_of(document.facts, "Method"), "output error");
  const Table table = test::table_of(test::section_of(document, "Searches and their cost").blocks, "Searches");
  std::vector<std::string> ends;
  for (const Row& row : table.rows) ends.push_back(test::shown_in(table, row, "ends"));
  EXPECT_THAT(ends, ElementsAre("at the best", "best", "elsewhere", ""));
  EXPECT_THAT(test::texts_of(test::section_of(document, "What only combinations are known of").blocks),
              Contains("A against B"));
}

TEST(MuscleTaskReport, OfAValidationSaysSo) {
  const Document document = muscle_task_report(study_of_a_person(), analysis_by_hand(), "veridyn test", true);
  EXPECT_EQ(document.subtitle, "An estimate validated on unseen tasks");
  EXPECT_THAT(report_of(study_of_a_person(), analysis_by_hand()).subtitle, Not(HasSubstr("validated")));
}

}  // namespace
}  // namespace veridyn::report
