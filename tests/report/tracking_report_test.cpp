#include "veridyn/report/tracking_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/report/shown.hpp"
#include "tests/support/elevator_flight.hpp"

namespace veridyn::report {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct TrackedAircraft {
  aircraft::FlightStudy study;
  aircraft::TrackingAnalysis analysis;
};

/// The elevator is moved for a minute. @param more further lines of the study
TrackedAircraft tracked_aircraft(const std::string& more) {
  const std::string text = veridyn::test::elevator_flight(1) + R"toml([reconstruct]
sensors = "reference"
turbulence = "none"
[delays]
automatic = false
[track]
coefficients = ["Cm", "CD"]
detection_learning = "15 s"
)toml" + more;
  Progress silent;
  aircraft::FlightStudy study = aircraft::read_study(Study::parse(text, "test.toml"), silent);
  aircraft::TrackingAnalysis analysis = track_flight(study, silent);
  return {std::move(study), std::move(analysis)};
}

Document report_of(const TrackedAircraft& a) {
  Document document = tracking_report(a.study, a.analysis.flight, "veridyn test");
  check(document);
  return document;
}

TEST(TrackingReport, SaysThatNothingChangedAndHowOftenThatWouldBeWrong) {
  const TrackedAircraft a = tracked_aircraft("");
  const Document document = report_of(a);
  EXPECT_EQ(document.verdict.word, "No change");
  EXPECT_THAT(document.verdict.lines, Contains("No coefficient changed during the flight."));
  EXPECT_THAT(document.verdict.lines, Contains(HasSubstr("Stated rate of false alarms: one per ")));
  EXPECT_THAT(test::titles_of(document), Not(Contains("Changes")));
  EXPECT_THAT(test::titles_of(document), Not(Contains("Guarded filter")));
  EXPECT_THAT(test::fact_of(document.facts, "Memory"), HasSubstr("a sample counts 5 % after"));
}

TEST(TrackingReport, ShowsTheParametersAsTheyStandNextToTheTruth) {
  const TrackedAircraft a = tracked_aircraft("");
  const Document document = report_of(a);
  const Table table = test::blocks_of<Table>(test::section_of(document, "Parameters").blocks).at(0);
  ASSERT_EQ(table.columns.back().name, "truth") << "the flight was simulated";
  const Row& row = test::row_of(table, "Cm_alpha");
  const estimation::Estimate estimate = a.analysis.flight.estimate();
  EXPECT_NEAR(*row.cells[1].number, estimate.find("Cm_alpha")->value, 1e-15);
  EXPECT_EQ(*row.cells.back().number, *a.study.true_subject->model.find(aircraft::Coefficient::kCm)->value_of("alpha"));
  const TimeSeries figure = test::blocks_of<TimeSeries>(test::section_of(document, "Cm").blocks).at(0);
  EXPECT_THAT(test::labels_of(figure), Contains("Cm_alpha"));
  EXPECT_THAT(test::labels_of(figure), Contains("suspicion (1: alarm)"));
  EXPECT_THAT(test::lines_of(figure.panels[0]), ElementsAre("on line", "truth"));
  EXPECT_TRUE(test::section_of(document, "Cm").folded) << "where nothing changed one need not look";
}

TEST(TrackingReport, FindsAChangeAndShowsTheNewTruthFromThereOn) {
  const TrackedAircraft a = tracked_aircraft("[[flight.change]]\ntime = 40\nparameters = { Cm_alpha = -0.2 }\n");
  ASSERT_FALSE(a.analysis.flight.tracker().changes().empty());
  const Document document = report_of(a);
  EXPECT_EQ(document.verdict.word, "The aircraft changed");
  EXPECT_THAT(document.verdict.lines, Contains(HasSubstr(" in Cm.")));
  const Table changes = test::table_of(test::section_of(document, "Changes").blocks, "Changes found");
  EXPECT_EQ(test::shown_in(changes, changes.rows[0], "coefficient"), "Cm");
  EXPECT_GT(*changes.rows[0].cells[1].number, 40.0);
  EXPECT_FALSE(test::section_of(document, "Cm").folded);
  const TimeSeries figure = test::blocks_of<TimeSeries>(test::section_of(document, "Cm").blocks).at(0);
  EXPECT_TRUE(std::ranges::any_of(figure.spans, [](const Span& s) { return s.label == "change"; }));
  for (const Panel& panel : figure.panels) {
    if (panel.label != "Cm_alpha") continue;
    EXPECT_EQ(panel.lines[1].y.back(), -0.2);
    EXPECT_NE(panel.lines[1].y.front(), -0.2);
  }
}

TEST(TrackingReport, SaysThatChangesWereNotLookedFor) {
  EXPECT_THAT(report_of(tracked_aircraft("detect_changes = false\n")).verdict.lines,
              Contains("Changes were not looked for."));
}

}  // namespace
}  // namespace veridyn::report
