#include "veridyn/report/drive_tracking_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/report/shown.hpp"
#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::report {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

struct TrackedCar {
  vehicle::VehicleStudy study;
  vehicle::DriveTracking tracking;
};

/// A lively drive of a family car whose grip falls to 60 % at a time.
TrackedCar tracked_car(double duration, double drop_s) {
  using Linear = vehicle::BicycleModel<double, vehicle::LinearTyre<double>>;
  const vehicle::VehicleParameters<double> p = vehicle::testing::family_car();
  vehicle::VehicleParameters<double> wet = p;
  wet.C_f *= 0.6;
  wet.C_r *= 0.6;
  const vehicle::testing::WanderingSteer steer(1, 0.02, 0.1, 1.0);
  const vehicle::VehicleTrajectory t = vehicle::testing::drive_bicycle<Linear>(
      [&](double at) { return vehicle::testing::linear_bicycle(at < drop_s ? p : wet); }, duration,
      [&](double at) { return steer(at); }, [](double at) { return 20.0 + 2.0 * std::sin(0.2 * at); });
  vehicle::VehicleStudy study;
  study.name = "wet <road>";
  study.subject_name = "car";
  study.vehicle = p;
  study.log.mapped = vehicle::testing::mapped(record_drive(t, vehicle::reference_drive_sensors(), 1));
  study.log.mapped.recording.source = "drive.csv";
  study.truth = {{"C_f", p.C_f}};
  Progress silent;
  vehicle::DriveTracking tracking = track(study, silent);
  return {std::move(study), std::move(tracking)};
}

Document report_of(const TrackedCar& car) {
  Document document = drive_tracking_report(car.study, car.tracking.drive, {.program = "veridyn test"});
  check(document);
  return document;
}

TEST(DriveTrackingReport, SaysWhatChangedAndWhen) {
  const TrackedCar car = tracked_car(60.0, 40.0);
  ASSERT_FALSE(car.tracking.drive.tracker()->changes().empty());
  const Document document = report_of(car);
  EXPECT_EQ(document.title, "wet <road>");
  EXPECT_EQ(document.verdict.word, "Changed");
  EXPECT_NE(document.verdict.level, Level::kGood);
  EXPECT_EQ(test::fact_of(document.facts, "Log"), "drive.csv");
  const Table table = test::table_of(test::section_of(document, "Changes").blocks, "Changes found");
  ASSERT_EQ(table.rows.size(), car.tracking.drive.tracker()->changes().size());
  EXPECT_GT(*table.rows[0].cells[1].number, 40.0) << "detected";
  const std::vector<TimeSeries> figures = test::blocks_of<TimeSeries>(test::section_of(document, "Over time").blocks);
  const auto changed = [](const TimeSeries& figure) {
    return std::ranges::any_of(figure.spans, [](const Span& s) { return s.label == "change"; });
  };
  EXPECT_TRUE(std::ranges::any_of(figures, changed)) << "shaded in the figure of what revealed it";
}

TEST(DriveTrackingReport, ShowsEachQuantityInUnitsForReadingWithTheTruthThatIsKnown) {
  const TrackedCar car = tracked_car(30.0, 1e9);
  const Document document = report_of(car);
  EXPECT_EQ(document.verdict.word, "No change");
  EXPECT_THAT(test::texts_of(test::section_of(document, "Changes").blocks), ElementsAre("None."));
  const std::vector<TimeSeries> figures = test::blocks_of<TimeSeries>(test::section_of(document, "Over time").blocks);
  ASSERT_EQ(figures.size(), 3U);
  EXPECT_THAT(test::labels_of(figures[0]), ElementsAre("C_f", "suspicion (1: alarm)"));
  EXPECT_THAT(test::lines_of(figures[0].panels[0]), ElementsAre("on line", "truth at the start"));
  EXPECT_EQ(figures[0].panels[0].lines[1].y.front(), vehicle::testing::family_car().C_f);
  EXPECT_THAT(test::lines_of(figures[1].panels[0]), ElementsAre("on line")) << "of C_r no truth is known";
  EXPECT_EQ(figures[2].panels[0].unit, "deg/g");
  const vehicle::DriveTracker& tracker = *car.tracking.drive.tracker();
  const double gradient = tracker.history(vehicle::TrackedAxle::kUndersteer).value.back();
  EXPECT_NEAR(figures[2].panels[0].lines[0].y.back(), gradient * kGravity / kDegree, 1e-9);
  EXPECT_THAT(test::fact_of(document.facts, "Rows"), HasSubstr(std::to_string(tracker.rows()) + " at "));
}

TEST(DriveTrackingReport, OfADriveTooShortToLearnTheNoiseIsBadAndHasNoFigures) {
  vehicle::VehicleStudy study;
  study.name = "short";
  const Document document = drive_tracking_report(study, vehicle::TrackedDrive(study), {.program = "veridyn test"});
  EXPECT_EQ(document.verdict.level, Level::kBad);
  EXPECT_TRUE(document.sections.empty());
}

}  // namespace
}  // namespace veridyn::report
