#include "bench/reproduction/report/vehicle_reproduction_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "tests/report/scaled_car.hpp"
#include "tests/report/shown.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

vehicle::VehicleReproduction reproduction_of_the_twin() {
  test::ScaledCar car = test::scaled_twin();
  vehicle::VehicleReproduction r;
  r.title = "step steer";
  r.finding = "they move alike";
  r.study = std::move(car.study);
  r.analysis = std::move(car.analysis);
  r.numbers = {{.run = "prototype",
                .quantity = "yaw_rate",
                .time = 1.0,
                .printed = "34.9515 deg/s",
                .unit = "deg/s",
                .published = 34.9515,
                .ours = 34.95152,
                .tolerance = 5e-5},
               {.run = "exact twin",
                .quantity = "radius",
                .time = 1.0,
                .printed = "32.8 m",
                .unit = "m",
                .published = 32.8,
                .ours = 33.0,
                .tolerance = 0.05}};
  r.checks = {{.passed = false, .text = "radius"}};
  return r;
}

TEST(VehicleReproductionReport, PutsPrintedNumbersNextToOurs) {
  const ReproducedRow row = reproduced_row(reproduction_of_the_twin());
  check({.sections = {{.blocks = row.blocks}}});
  EXPECT_FALSE(row.passed());
  EXPECT_THAT(row.ours, HasSubstr("at 20 m/s, four-wheel model, step steer manoeuvre, Runge-Kutta at 1 ms."));
  const Table table = test::table_of(row.blocks, "Printed numbers");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_THAT(test::shown_row(table, 0),
              ElementsAre("prototype", "yaw_rate", "1.000", "34.9515 deg/s", "34.951520", "deg/s", "good"));
  EXPECT_EQ(table.rows[1].cells.back().status, Status::kBad);
}

TEST(VehicleReproductionReport, HasGroupsDifferencesAndFiguresThatZoomTogether) {
  vehicle::VehicleReproduction r = reproduction_of_the_twin();
  r.numbers.clear();
  const ReproducedRow row = reproduced_row(r);
  EXPECT_EQ(test::blocks_of<Table>(row.blocks).front().title, "Groups") << "nothing was printed";
  EXPECT_NO_THROW(static_cast<void>(test::table_of(row.blocks, "Largest differences over the drive")));
  const std::vector<TimeSeries> figures = test::blocks_of<TimeSeries>(row.blocks);
  EXPECT_EQ(figures.size(), 3U);
  for (const TimeSeries& figure : figures) EXPECT_EQ(figure.axis, "step steer") << figure.title;
}

TEST(VehicleReproductionReport, SaysThatTheSourcesConventionIsKept) {
  vehicle::VehicleReproduction r = reproduction_of_the_twin();
  r.study.simulation.four_wheel.convention = vehicle::FourWheelConvention::kSource;
  EXPECT_THAT(reproduced_row(r).ours, HasSubstr("four-wheel model in the source's convention"));
}

}  // namespace
}  // namespace veridyn::report
