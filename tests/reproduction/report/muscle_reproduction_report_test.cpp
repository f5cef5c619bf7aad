#include "bench/reproduction/report/muscle_reproduction_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

muscle::ComparedPerson person(double error, double unseen) {
  muscle::ComparedPerson p;
  p.parameter_error = error;
  p.identified_error = 0.5 * error;
  p.trained = 1e-4;
  p.unseen = unseen;
  p.identified = 2;
  p.covered = 1;
  p.at_bound = 1;
  p.simulations = {.values = 10, .with_derivatives = 30};
  p.seconds = 2.5;
  return p;
}

/// Three hidden persons of two unknowns, by both routes.
muscle::MuscleReproduction two_routes() {
  muscle::MuscleReproduction r;
  r.title = "four tasks";
  r.finding = "the error falls";
  r.conditions = "Bounds of 20 %.";
  r.study.subject.model_name = "arm";
  r.study.unknowns.resize(2);
  r.study.person.emplace();
  r.study.person->noise = 0.06 * kDegree;
  r.cases = {{.setting = {.name = "ours", .tasks = {8, 33}, .load = 1.0, .spread = 0.2},
              .persons = {person(0.01, 1e-3), person(0.02, 1e-2), person(0.04, 1e-4)}},
             {.setting = {.name = "theirs", .tasks = {8}, .load = 2.0, .spread = 0.05, .published = true},
              .persons = {person(0.1, 0.1), person(0.1, 0.1), person(0.1, 0.1)}}};
  r.checks = {{.passed = true, .text = "below"}};
  return r;
}

TEST(MuscleReproductionReport, ShowsMediansWithTheLargestInBrackets) {
  const ReproducedRow row = reproduced_row(two_routes());
  EXPECT_TRUE(row.passed());
  EXPECT_EQ(row.ours, "arm; 2 unknowns, 3 hidden persons, noise of 0.06 deg. Bounds of 20 %.");
  const Table table = test::table_of(row.blocks, "Cases");
  check({.sections = {{.blocks = row.blocks}}});
  ASSERT_EQ(table.rows.size(), 2U);
  const Row& ours = table.rows[0];
  EXPECT_EQ(test::shown_in(table, ours, "tasks"), "8, 33");
  EXPECT_EQ(test::shown_in(table, ours, "hidden within"), "20");
  EXPECT_EQ(test::shown_in(table, ours, "route"), "gradient");
  EXPECT_EQ(test::shown_in(table, ours, "parameter error"), "2 (4)") << "per cent";
  EXPECT_EQ(test::shown_in(table, ours, "unseen NRMSE"), "0.001 (0.01)");
  EXPECT_EQ(test::shown_in(table, ours, "identified"), "6 of 6") << "two of each of three persons";
  EXPECT_EQ(test::shown_in(table, ours, "inside 95 %"), "3 of 6");
  EXPECT_EQ(test::shown_in(table, ours, "at a bound"), "3");
  EXPECT_EQ(test::shown_in(table, ours, "simulations"), "40 (40)") << "with and without derivatives";
  EXPECT_EQ(test::shown_in(table, table.rows[1], "route"), "published");
}

TEST(MuscleReproductionReport, DrawsEveryPersonOfWhomThereIsAnEstimate) {
  muscle::MuscleReproduction r = two_routes();
  r.cases[0].persons[1].parameter_error = kNaN;
  r.cases[0].persons[2].unseen = 0.0;  // exact: no logarithm
  const XYPlot plot = test::blocks_of<XYPlot>(reproduced_row(r).blocks).at(0);
  ASSERT_EQ(plot.series.size(), 2U);
  ASSERT_EQ(plot.series[0].x.size(), 1U);
  EXPECT_NEAR(plot.series[0].x[0], -2.0, 1e-12);
  EXPECT_NEAR(plot.series[0].y[0], -3.0, 1e-12);
  for (muscle::ComparedOutcome& c : r.cases)
    for (muscle::ComparedPerson& p : c.persons) p.unseen = kNaN;
  EXPECT_THAT(test::blocks_of<XYPlot>(reproduced_row(r).blocks), IsEmpty());
}

TEST(MuscleReproductionReport, CountsOnePersonAndNone) {
  muscle::MuscleReproduction r = two_routes();
  r.cases.resize(1);
  r.cases[0].persons.resize(1);
  EXPECT_THAT(reproduced_row(r).ours, HasSubstr("1 hidden person, noise"));
  r.cases.clear();
  EXPECT_THAT(reproduced_row(r).ours, HasSubstr("0 hidden persons, noise"));
}

}  // namespace
}  // namespace veridyn::report
