#include "veridyn/report/vehicle_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct SimulatedCar {
  vehicle::SimulationStudy study;
  vehicle::SimulationRun run;
};

/// @param drive lines of `[drive]`
SimulatedCar simulated_car(const std::string& drive) {
  const Study study = Study::parse(
      "title = \"a drive\"\n[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\n" + drive, "s.toml");
  Progress silent;
  SimulatedCar car{.study = vehicle::read_simulation_study(study.root(), silent), .run = {}};
  car.run = vehicle::run_simulation_study(car.study, silent);
  return car;
}

Document report_of(const SimulatedCar& car) {
  Document document = vehicle_report(car.study, car.run, "veridyn test");
  check(document);
  return document;
}

TEST(VehicleReport, ShowsADriveWithItsMetricsAndItsLinearAnalysis) {
  const SimulatedCar car = simulated_car("manoeuvre = \"step steer\"\nspeed = 20\nduration = 4\n");
  const Document document = report_of(car);
  EXPECT_EQ(document.title, "a drive");
  EXPECT_EQ(document.verdict.level, Level::kGood);
  EXPECT_EQ(document.verdict.word, "Driven");
  EXPECT_THAT(test::titles_of(document),
              ElementsAre("Path and accelerations", "Time histories", "Tyres", "Body and wheels", "Steady cornering",
                          "Metrics", "Linear analysis", "Vehicle"));
  EXPECT_EQ(test::fact_of(document.facts, "Speed"), "20 m/s (72 km/h)");
  EXPECT_EQ(test::fact_of(document.facts, "Model"), "four-wheel");
  EXPECT_EQ(test::fact_of(document.facts, "Gravity"), "") << "that of the earth goes without saying";
  const double largest = car.run.trajectory.lateral_acceleration.back();
  EXPECT_THAT(document.verdict.lines, Contains(HasSubstr("Largest lateral acceleration")));
  EXPECT_GT(largest, 0.0);
  const Table metrics = test::table_of(test::section_of(document, "Metrics").blocks, "Metrics");
  EXPECT_EQ(metrics.rows.size(), car.run.metrics.size());
  const Section& linear = test::section_of(document, "Linear analysis");
  EXPECT_EQ(test::table_of(linear.blocks, "Eigenvalues of the bicycle").rows.size(), car.run.modes.size());
  EXPECT_EQ(test::table_of(linear.blocks, "Modes of the four-wheel model").columns.front().name, "mode");
}

TEST(VehicleReport, OfABicycleHasNoBodyThatRollsAndNoModesOfOne) {
  const Document document = report_of(
      simulated_car("model = \"bicycle\"\nmanoeuvre = \"step steer\"\nspeed = 20\nduration = 1\ngravity = 1.62\n"));
  EXPECT_THAT(test::titles_of(document), Not(Contains("Body and wheels")));
  for (const Table& table : test::blocks_of<Table>(test::section_of(document, "Linear analysis").blocks))
    EXPECT_NE(table.title, "Modes of the four-wheel model");
  EXPECT_EQ(test::fact_of(document.facts, "Gravity"), "1.62 m/s^2");
}

TEST(VehicleReport, DrawsTheConesOfACourse) {
  const SimulatedCar car =
      simulated_car("model = \"bicycle\"\nmanoeuvre = \"double lane change\"\nspeed = 20\nduration = 1\n");
  ASSERT_TRUE(car.study.manoeuvre.course.has_value());
  const Document document = report_of(car);
  const XYPlot path = test::blocks_of<XYPlot>(document.sections.at(0).blocks).at(0);
  const vehicle::Lane& lane = car.study.manoeuvre.course->lanes.front();
  ASSERT_EQ(path.series.size(), 1 + 2 * car.study.manoeuvre.course->lanes.size());
  EXPECT_EQ(path.series[1].name, "cones");
  EXPECT_THAT(path.series[1].x, ElementsAre(lane.begin, lane.end));
  EXPECT_THAT(path.series[1].y, ElementsAre(lane.left, lane.left));
  EXPECT_THAT(path.series[2].y, ElementsAre(lane.right, lane.right));
}

TEST(VehicleReport, DrawsCoursesEnlargedSidewaysAndOtherPathsToScale) {
  const auto path_of = [](const std::string& drive) {
    return test::blocks_of<XYPlot>(report_of(simulated_car(drive)).sections.at(0).blocks).at(0);
  };
  const XYPlot slalom = path_of("model = \"bicycle\"\nmanoeuvre = \"slalom\"\nspeed = 12\nduration = 1\ncones = 3\n");
  EXPECT_FALSE(slalom.equal_scale);
  EXPECT_THAT(slalom.caption, HasSubstr("not to scale"));
  ASSERT_EQ(slalom.series.size(), 2U);
  EXPECT_EQ(slalom.series[1].x.size(), 3U) << "a point for each cone";
  const XYPlot step = path_of("model = \"bicycle\"\nmanoeuvre = \"step steer\"\nspeed = 20\nduration = 1\n");
  EXPECT_TRUE(step.equal_scale);
  EXPECT_EQ(step.series.size(), 1U);
}

TEST(VehicleReport, SaysUndersteerAndRollOfTheFourWheelModelInDegPerG) {
  SimulatedCar car = simulated_car("manoeuvre = \"step steer\"\nspeed = 20\nduration = 1\n");
  ASSERT_TRUE(car.run.cornering.has_value());
  car.run.cornering = {.understeer_gradient = 2.5 * kDegree / kGravity, .roll_gradient = 5.25 * kDegree / kGravity};
  EXPECT_THAT(report_of(car).verdict.lines, Contains("With its suspension, in gentle turns: understeer gradient 2.5 "
                                                     "deg/g, roll gradient 5.25 deg/g."));
  car.run.cornering.reset();
  EXPECT_THAT(report_of(car).verdict.lines, Not(Contains(HasSubstr("With its suspension"))));
}

TEST(VehicleReport, ShowsAMetricInSIWhereItStandsInDegPerGToo) {
  SimulatedCar car = simulated_car("model = \"bicycle\"\nmanoeuvre = \"step steer\"\nspeed = 20\nduration = 1\n");
  car.run.metrics = {{"roll_gradient", 0.01, "rad s^2/m", "ISO 4138"},
                     {"roll_gradient_deg_per_g", 5.6188, "deg/g", "ISO 4138"},
                     {"sideslip_gradient", 0.01, "rad s^2/m", "ISO 4138"}};
  const Table table = test::table_of(test::section_of(report_of(car), "Metrics").blocks, "Metrics");
  EXPECT_EQ(test::shown_in(table, test::row_of(table, "roll_gradient"), "unit"), "rad s^2/m");
  EXPECT_EQ(test::shown_in(table, test::row_of(table, "roll_gradient"), "value"), "0.01000");
  EXPECT_EQ(test::shown_in(table, test::row_of(table, "roll_gradient_deg_per_g"), "value"), "5.619");
  EXPECT_EQ(test::shown_in(table, test::row_of(table, "sideslip_gradient"), "unit"), "deg/g") << "has no twin";
}

TEST(VehicleReport, SaysHowADriveEnded) {
  SimulatedCar car = simulated_car("model = \"bicycle\"\nmanoeuvre = \"step steer\"\nspeed = 20\nduration = 1\n");
  car.run.trajectory.end = vehicle::DriveEnd::kDiverged;
  const Document diverged = report_of(car);
  EXPECT_EQ(diverged.verdict.level, Level::kBad);
  EXPECT_EQ(diverged.verdict.word, "Ended early");
  EXPECT_TRUE(std::isupper(static_cast<unsigned char>(diverged.verdict.headline.front())) != 0);
  EXPECT_EQ(diverged.verdict.headline.back(), '.');
  car.run.trajectory.end = vehicle::DriveEnd::kCompleted;
  car.run.trajectory.lift_offs = {{.wheel = 2, .from = 0.5, .to = 0.75}};
  const Document lifted = report_of(car);
  EXPECT_EQ(lifted.verdict.level, Level::kCaution) << "a wheel left the ground";
  EXPECT_EQ(lifted.verdict.word, "Driven");
}

TEST(VehicleReport, SaysFromWhichSpeedOnAnOversteeringCarIsUnstable) {
  SimulatedCar car = simulated_car("model = \"bicycle\"\nmanoeuvre = \"step steer\"\nspeed = 20\nduration = 1\n");
  car.run.characteristics.understeer_gradient = -1.0 * kDegree / kGravity;
  car.run.characteristics.critical_speed = 33.0;
  EXPECT_THAT(report_of(car).verdict.lines, Contains("Oversteering: -1 deg/g; unstable above 33 m/s."));
  car.run.characteristics.understeer_gradient = 2.0 * kDegree / kGravity;
  car.run.characteristics.critical_speed = kInfinity;
  car.run.characteristics.characteristic_speed = 22.0;
  EXPECT_THAT(report_of(car).verdict.lines, Contains("Understeering: 2 deg/g; characteristic speed 22 m/s."));
  car.run.characteristics.understeer_gradient = 0.0;
  car.run.characteristics.characteristic_speed = kInfinity;
  EXPECT_THAT(report_of(car).verdict.lines, Contains(HasSubstr("Neutral steering")));
}

TEST(VehicleReport, SaysWhatWasAssumed) {
  SimulatedCar car = simulated_car("model = \"bicycle\"\nmanoeuvre = \"step steer\"\nspeed = 20\nduration = 1\n");
  car.study.vehicle.assumed = {"track_f = 1.35 m (0.6 L)"};
  car.study.vehicle.warnings = {"heavy"};
  const Document document = report_of(car);
  EXPECT_THAT(document.verdict.lines, Contains("1 numbers that this model does not need were assumed."));
  EXPECT_THAT(test::texts_of(test::section_of(document, "Vehicle").blocks), Contains("track_f = 1.35 m (0.6 L)"));
  EXPECT_THAT(test::texts_of(test::section_of(document, "Warnings").blocks), ElementsAre("heavy"));
}

TEST(VehicleTable, HasEveryNumberWithItsUnitAndMeaning) {
  vehicle::VehicleParameters<double> p;
  p.mass = 1100.0;
  const Table table = vehicle_table(p);
  EXPECT_EQ(table.rows.size(), vehicle::kVehicleFields.size());
  const Row& mass = test::row_of(table, "mass");
  EXPECT_EQ(test::shown_in(table, mass, "value"), "1100.00");
  EXPECT_EQ(test::shown_in(table, mass, "unit"), "kg");
  for (const Row& row : table.rows) EXPECT_NE(test::shown_in(table, row, "unit"), "1") << row.cells[0].text;
}

// The gain at low frequency is that of steady cornering, and phases go on beyond half a turn without a jump.
TEST(FrequencyResponseFigures, BeginAtTheSteadyGainAndHaveNoJumps) {
  const SimulatedCar car = simulated_car("model = \"bicycle\"\nmanoeuvre = \"step steer\"\nspeed = 20\nduration = 1\n");
  const std::vector<NamedBicycle> bicycles{{"a", car.run.linear}, {"b", car.run.linear, Role::kReference}};
  const std::vector<XYPlot> plots = test::blocks_of<XYPlot>(frequency_response_figures(bicycles));
  ASSERT_EQ(plots.size(), 6U) << "gain and phase of three quantities";
  EXPECT_EQ(plots[0].series.size(), 2U);
  EXPECT_EQ(plots[0].series[1].role, Role::kReference);
  // A car with one second of lag and less is steady within a percent at 0.05 Hz.
  EXPECT_NEAR(plots[0].series[0].y.front(), car.run.characteristics.yaw_rate_gain,
              0.01 * car.run.characteristics.yaw_rate_gain);
  EXPECT_NEAR(plots[2].series[0].y.front(), 20.0 * car.run.characteristics.yaw_rate_gain * kDegree,
              0.01 * 20.0 * car.run.characteristics.yaw_rate_gain * kDegree)
      << "u r, per degree";
  for (const std::size_t phase : {1U, 3U, 5U}) {
    const std::vector<double>& y = plots[phase].series[0].y;
    for (std::size_t k = 1; k < y.size(); ++k) EXPECT_LT(std::abs(y[k] - y[k - 1]), 30.0) << plots[phase].title;
  }
}

}  // namespace
}  // namespace veridyn::report
