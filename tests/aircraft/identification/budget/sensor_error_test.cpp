#include "veridyn/aircraft/identification/budget/sensor_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

/// Two seconds in which alpha is a sine of 1 Hz.
FlightSignals signals() {
  FlightSignals s;
  s.grid = {0.0, 0.01, 201};
  for (std::size_t k = 0; k < s.grid.count; ++k) {
    s[FlightSignal::kAlpha].value.push_back(0.1 * std::sin(kFullTurn * s.grid.at(k)));
    s[FlightSignal::kAirspeed].value.push_back(20.0);
    s[FlightSignal::kThrust].value.push_back(10.0);
    s.thrust_per_airspeed.push_back(-1.2);
    s.air_density.push_back(1.2);
  }
  return s;
}

TEST(SensorError, ADelayMovesASignalByPartsOfASample) {
  const FlightSignals late = with_error(signals(), BudgetSensor::kAlpha, SensorErrorKind::kDelay, 0.0237);
  for (std::size_t k = 10; k < 190; ++k)
    EXPECT_NEAR(late[FlightSignal::kAlpha].value[k], 0.1 * std::sin(kFullTurn * (signals().grid.at(k) - 0.0237)), 2e-6);
  // Taken off again it is the signal as it was; a hole stays one and does not spread far.
  FlightSignals back = without_errors(late, {{BudgetSensor::kAlpha, SensorErrorKind::kDelay, 0.0237, 0.0}});
  EXPECT_NEAR(back[FlightSignal::kAlpha].value[100], signals()[FlightSignal::kAlpha].value[100], 5e-6);
  FlightSignals hole = signals();
  hole[FlightSignal::kAlpha].value[100] = kNaN;
  hole = with_error(std::move(hole), BudgetSensor::kAlpha, SensorErrorKind::kDelay, 0.005);
  EXPECT_TRUE(std::isnan(hole[FlightSignal::kAlpha].value[100]));
  EXPECT_TRUE(std::isfinite(hole[FlightSignal::kAlpha].value[97]));
  EXPECT_TRUE(std::isfinite(hole[FlightSignal::kAlpha].value[104]));
}

TEST(SensorError, AScaleOfTheAirspeedTakesItsThrustAlong) {
  const FlightSignals fast = with_error(signals(), BudgetSensor::kAirspeed, SensorErrorKind::kScale, 0.05);
  EXPECT_DOUBLE_EQ(fast[FlightSignal::kAirspeed].value[3], 21.0);
  EXPECT_DOUBLE_EQ(fast[FlightSignal::kThrust].value[3], 8.8);
  const FlightSignals back = without_errors(fast, {{BudgetSensor::kAirspeed, SensorErrorKind::kScale, 0.05, 0.0}});
  EXPECT_NEAR(back[FlightSignal::kAirspeed].value[3], 20.0, 1e-12);
  EXPECT_NEAR(back[FlightSignal::kThrust].value[3], 10.0, 1e-12);
  EXPECT_DOUBLE_EQ(with_error(signals(), BudgetSensor::kAirDensity, SensorErrorKind::kScale, 0.01).air_density[0],
                   1.212);
}

// A recorded command is ahead of its surface: x + T x' of a sine, T = 50 ms at 1 Hz.
TEST(SensorError, ALagIsTakenOffACommandAndNoneOfItsJumpsIsLeft) {
  constexpr double kLag = 0.05;
  FlightSignals command = signals();
  for (std::size_t k = 0; k < command.grid.count; ++k)
    command[FlightSignal::kElevator].value.push_back(0.1 * std::sin(kFullTurn * command.grid.at(k)));
  command.jumps = {{FlightSignal::kElevator, 100}, {FlightSignal::kRudder, 100}};
  const FlightSignals surface = without_errors(command, {{BudgetSensor::kElevator, SensorErrorKind::kLag, kLag, 0.0}});
  const double turn = kFullTurn * kLag, gain = 1.0 / std::hypot(1.0, turn);
  for (std::size_t k = 60; k < 200; ++k)
    EXPECT_NEAR(surface[FlightSignal::kElevator].value[k],
                0.1 * gain * std::sin(kFullTurn * command.grid.at(k) - std::atan(turn)), 5e-5);
  ASSERT_EQ(surface.jumps.size(), 1U);
  EXPECT_EQ(surface.jumps.front().control, FlightSignal::kRudder);
  const FlightSignals back = with_error(surface, BudgetSensor::kElevator, SensorErrorKind::kLag, kLag);
  EXPECT_NEAR(back[FlightSignal::kElevator].value[130], command[FlightSignal::kElevator].value[130], 2e-4);
}

TEST(SensorError, APlaceOfTheAccelerometerAddsTheAccelerationOfItsArm) {
  FlightSignals turning = signals();
  const std::vector<double> none(turning.grid.count, 0.0);
  for (const FlightSignal s : {FlightSignal::kAx, FlightSignal::kAy, FlightSignal::kAz, FlightSignal::kP,
                               FlightSignal::kR, FlightSignal::kPdot, FlightSignal::kRdot})
    turning[s].value = none;
  turning[FlightSignal::kQ].value.assign(turning.grid.count, 2.0);
  turning[FlightSignal::kQdot].value.assign(turning.grid.count, 3.0);
  const FlightSignals ahead = with_error(turning, BudgetSensor::kAccelerometer, SensorErrorKind::kPlaceX, 0.1);
  EXPECT_NEAR(ahead[FlightSignal::kAx].value[5], -0.4, 1e-12);  // to the centre, q^2 x
  EXPECT_NEAR(ahead[FlightSignal::kAz].value[5], -0.3, 1e-12);  // up with q', -q' x
  EXPECT_EQ(with_error(turning, BudgetSensor::kAccelerometer, SensorErrorKind::kZeroY, 0.2)[FlightSignal::kAy].value[5],
            0.2);
}

TEST(SensorError, WhatTheFlightHasNotIsLeftAlone) {
  const FlightSignals same = with_error(signals(), BudgetSensor::kBeta, SensorErrorKind::kZero, 1.0);
  EXPECT_FALSE(same[FlightSignal::kBeta].available());
}

TEST(SensorError, CoefficientsRestOnTheSensorsOfTheirRows) {
  EXPECT_TRUE(rests_on(Coefficient::kCm, BudgetSensor::kElevator));
  EXPECT_FALSE(rests_on(Coefficient::kCn, BudgetSensor::kAlpha));
  EXPECT_TRUE(rests_on(Coefficient::kCY, BudgetSensor::kAccelerometer));
  EXPECT_FALSE(rests_on(Coefficient::kCl, BudgetSensor::kAccelerometer));
  EXPECT_TRUE(rests_on(Coefficient::kCn, BudgetSensor::kAirspeed));
}

}  // namespace
}  // namespace veridyn::aircraft
