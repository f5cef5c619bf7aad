#include "veridyn/aircraft/model/atmosphere.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::aircraft {
namespace {

// Of the tables of ISO 2533 and the US Standard Atmosphere 1976, geopotential altitudes; six digits, the last rounded.
TEST(StandardAtmosphere, MatchesThePublishedTable) {
  struct Row {
    double altitude, temperature, pressure, density;
  };
  for (const Row& row : {Row{0.0, 288.15, 101325.0, 1.2250}, Row{5000.0, 255.65, 54019.9, 0.736116},
                         Row{11000.0, 216.65, 22632.1, 0.363918}, Row{20000.0, 216.65, 5474.89, 0.0880349}}) {
    const Air<double> air = standard_atmosphere(row.altitude);
    EXPECT_NEAR(air.temperature, row.temperature, 1e-9) << row.altitude;
    EXPECT_NEAR(air.pressure / row.pressure, 1.0, 4e-6) << row.altitude;
    EXPECT_NEAR(air.density / row.density, 1.0, 4e-5) << row.altitude;
  }
}

// dp/dh = -rho g, by central differences of 1 m whose error is below 1e-8 of the slope.
TEST(StandardAtmosphere, IsInHydrostaticEquilibriumInBothLayersAndContinuousBetweenThem) {
  for (const double h : {-2000.0, 0.0, 3000.0, 10500.0, 11500.0, 18000.0}) {
    const double slope = (standard_atmosphere(h + 1.0).pressure - standard_atmosphere(h - 1.0).pressure) / 2.0;
    EXPECT_NEAR(slope / (-standard_atmosphere(h).density * kGravity), 1.0, 1e-6) << h;
  }
  EXPECT_NEAR(standard_atmosphere(11000.0 - 1e-6).pressure, standard_atmosphere(11000.0).pressure, 1e-4);
}

// ISO 2533, table values at geopotential altitude.
TEST(StandardAtmosphere, HasTheDensityAndPressureOfIso2533) {
  const auto sea = standard_atmosphere(0.0);
  EXPECT_NEAR(sea.density, 1.225, 1e-5);
  EXPECT_NEAR(sea.temperature, 288.15, 1e-12);
  const auto five = standard_atmosphere(5000.0);
  EXPECT_NEAR(five.pressure, 54019.9, 0.1);
  EXPECT_NEAR(five.density, 0.736116, 1e-6);
  const auto eleven = standard_atmosphere(11000.0);
  EXPECT_NEAR(eleven.pressure, 22632.0, 0.1);
  const auto fifteen = standard_atmosphere(15000.0);
  EXPECT_NEAR(fifteen.pressure, 12044.5, 0.3);
  EXPECT_NEAR(fifteen.density, 0.193674, 1e-5);
}

}  // namespace
}  // namespace veridyn::aircraft
