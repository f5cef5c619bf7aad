#include "veridyn/report/parts/steady_cornering_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A drive at 20 m/s with 2 deg of steer per g beyond L/R, and 5 deg of roll per g, up to 0.3 g in a left turn.
struct TurningCar {
  vehicle::SimulationStudy study;
  vehicle::SimulationRun run;

  TurningCar() {
    study.manoeuvre.kind = vehicle::ManoeuvreKind::kSteadyStateCircle;
    const double wheelbase = study.vehicle.parameters.wheelbase();
    vehicle::VehicleTrajectory& t = run.trajectory;
    for (int k = 0; k <= 30; ++k) {
      const double g = 0.01 * k, r = g * kGravity / 20.0;
      t.time.push_back(k);
      t.u.push_back(20.0);
      t.v.push_back(0.0);
      t.r.push_back(r);
      t.steer.push_back(wheelbase * r / 20.0 + 2.0 * kDegree * g);
      t.roll.push_back(5.0 * kDegree * g);
    }
    run.characteristics.understeer_gradient = 1.0 * kDegree / kGravity;
    run.cornering = {.understeer_gradient = 1.9 * kDegree / kGravity, .roll_gradient = 4.9 * kDegree / kGravity};
  }
};

TEST(SteadyCorneringSection, ShowsGradientsInDegPerGBesideSI) {
  const TurningCar car;
  const Section section = steady_cornering_section(car.study, car.run);
  check({.sections = {section}});
  const Table table = test::table_of(section.blocks, "Understeer and roll");
  ASSERT_EQ(table.rows.size(), 5U);
  EXPECT_EQ(table.columns[1].unit, "deg/g");
  EXPECT_EQ(table.columns[2].unit, "rad s^2/m");
  // 1 deg/g is 0.0017797 rad s^2/m.
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("understeer", "2.00", "0.00356", HasSubstr("this drive")));
  EXPECT_THAT(test::shown_row(table, 1), ElementsAre("understeer", "1.90", "0.00338", HasSubstr("four-wheel")));
  EXPECT_THAT(test::shown_row(table, 2), ElementsAre("understeer", "1.00", "0.00178", HasSubstr("linear bicycle")));
  EXPECT_THAT(test::shown_row(table, 3), ElementsAre("roll", "5.00", "0.00890", HasSubstr("this drive")));
  EXPECT_THAT(test::shown_row(table, 4), ElementsAre("roll", "4.90", "0.00872", HasSubstr("four-wheel")));
}

TEST(SteadyCorneringSection, DrawsWhatWasDrivenWithItsSlope) {
  const TurningCar car;
  const auto plots = test::blocks_of<XYPlot>(steady_cornering_section(car.study, car.run).blocks);
  ASSERT_EQ(plots.size(), 2U);
  EXPECT_EQ(plots[0].title, "Understeer diagram");
  EXPECT_NEAR(plots[0].series[0].x.back(), 0.3, 1e-12) << "g";
  EXPECT_NEAR(plots[0].series[0].y.back(), 0.6, 1e-12) << "deg";
  EXPECT_EQ(plots[0].series[1].name, "2.00 deg/g");
  EXPECT_NEAR(plots[0].series[1].x.back(), 0.3, 1e-12) << "the line ends where the drive does";
  EXPECT_NEAR(plots[0].series[1].y.back(), 0.6, 1e-9);
  EXPECT_EQ(plots[1].series[1].name, "5.00 deg/g");
}

TEST(SteadyCorneringSection, OfABicycleOnAnotherManoeuvreHasItsOneNumber) {
  TurningCar car;
  car.study.manoeuvre.kind = vehicle::ManoeuvreKind::kStepSteer;
  car.run.cornering.reset();
  car.run.trajectory.roll.clear();
  const Section section = steady_cornering_section(car.study, car.run);
  EXPECT_THAT(test::blocks_of<XYPlot>(section.blocks), IsEmpty()) << "no steady turn";
  const Table table = test::table_of(section.blocks, "Understeer and roll");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("understeer", "1.00", "0.00178", HasSubstr("linear bicycle")));
}

}  // namespace
}  // namespace veridyn::report
