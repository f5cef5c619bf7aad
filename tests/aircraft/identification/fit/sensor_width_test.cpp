#include "veridyn/aircraft/identification/fit/sensor_width.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Outcome;
using estimation::Parameter;
using estimation::ParameterStatus;
using ::testing::HasSubstr;
using ::testing::Not;

FlightSignals flown_signals() {
  FlightSignals signals;
  signals.grid = {0.0, 0.01, 3};
  signals[FlightSignal::kAlpha].value = {0.01, 0.05, 0.09};
  signals[FlightSignal::kAirspeed].value = {18.0, 20.0, 22.0};
  return signals;
}

SensorBudget budget_of(const std::vector<SensorError>& errors) {
  SensorBudget budget;
  budget.add(errors);
  return budget;
}

Eigen::Index column_of(BudgetSensor sensor, SensorErrorKind kind) {
  return signed_index(place_of({.sensor = sensor, .kind = kind}));
}

const SensorError kScaleOfAlpha{BudgetSensor::kAlpha, SensorErrorKind::kScale, 0.0, 0.05};
const SensorError kZeroOfAlpha{BudgetSensor::kAlpha, SensorErrorKind::kZero, 0.0, 0.02};

TEST(SensorSensitivity, IsThatOfALinearLawInClosedForm) {
  // A slope over alpha and a constant: a scale of alpha divides the slope, a zero moves the constant by it.
  constexpr double kSlope = 4.0, kConstant = 0.3;
  const auto estimate = [&](const FlightSignals& changed) {
    const std::vector<double>& a = changed[FlightSignal::kAlpha].value;
    const std::vector<double> truth = flown_signals()[FlightSignal::kAlpha].value;
    const double slope = kSlope * (truth[2] - truth[0]) / (a[2] - a[0]);
    return Eigen::VectorXd(Eigen::Vector2d(kConstant + kSlope * truth[0] - slope * a[0], slope));
  };
  const Eigen::VectorXd theta = Eigen::Vector2d(kConstant, kSlope);
  const Eigen::MatrixXd J =
      sensor_sensitivity(flown_signals(), budget_of({kScaleOfAlpha, kZeroOfAlpha}), Coefficient::kCL, theta, estimate);
  const Eigen::Index scale = column_of(BudgetSensor::kAlpha, SensorErrorKind::kScale),
                     zero = column_of(BudgetSensor::kAlpha, SensorErrorKind::kZero);
  EXPECT_NEAR(J(0, scale), 0.0, 1e-12);
  EXPECT_NEAR(J(1, scale), -0.05 * kSlope, 0.01 * 0.05 * kSlope);
  EXPECT_NEAR(J(0, zero), -0.02 * kSlope, 1e-12);
  EXPECT_NEAR(J(1, zero), 0.0, 1e-12);
  // Without correlation, which adds up the two.
  SensorBudget together;
  together.add({kScaleOfAlpha, kZeroOfAlpha}, Eigen::Matrix2d{{0.0025, 0.0005}, {0.0005, 0.0004}});
  const Eigen::MatrixXd C = sensor_sensitivity(flown_signals(), together, Coefficient::kCL, theta, estimate);
  EXPECT_NEAR((C * C.transpose())(0, 1), (J * J.transpose())(0, 1) + 0.5 * J(0, zero) * J(1, scale), 1e-6);
}

TEST(SensorSensitivity, LeavesOutWhatACoefficientDoesNotRestOnOrCannotBeEstimatedAgain) {
  const Eigen::VectorXd theta = Eigen::Vector2d(1.0, 2.0);
  const auto twice = [&](const FlightSignals&) { return Eigen::VectorXd(2.0 * theta); };
  const SensorBudget budget = budget_of({kScaleOfAlpha});
  EXPECT_TRUE(sensor_sensitivity(flown_signals(), budget, Coefficient::kCn, theta, twice).isZero());
  EXPECT_FALSE(sensor_sensitivity(flown_signals(), budget, Coefficient::kCm, theta, twice).isZero());
  EXPECT_TRUE(sensor_sensitivity(flown_signals(), budget, Coefficient::kCm, theta, [](const FlightSignals&) {
                return Eigen::VectorXd();
              }).isZero());
}

TEST(IntervalParts, AreTheRootsOfVariancesThatAddUp) {
  Eigen::MatrixXd sensors = Eigen::MatrixXd::Zero(1, kSensorErrors);
  sensors(0, column_of(BudgetSensor::kAlpha, SensorErrorKind::kScale)) = 3.0;
  sensors(0, column_of(BudgetSensor::kAirspeed, SensorErrorKind::kScale)) = 4.0;
  sensors(0, column_of(BudgetSensor::kAlpha, SensorErrorKind::kDelay)) = 1.2;
  sensors(0, column_of(BudgetSensor::kElevator, SensorErrorKind::kLag)) = 1.6;
  sensors(0, column_of(BudgetSensor::kAccelerometer, SensorErrorKind::kPlaceX)) = std::sqrt(5.0);
  const IntervalParts parts =
      interval_parts(Eigen::VectorXd::Constant(1, 0.5), sensors, Eigen::MatrixXd::Constant(1, 4, 1.0));
  EXPECT_DOUBLE_EQ(parts.noise(0), 0.5);
  EXPECT_DOUBLE_EQ(parts.air_data(0), 5.0);
  EXPECT_DOUBLE_EQ(parts.delays(0), 2.0);
  EXPECT_DOUBLE_EQ(parts.body(0), 3.0);
}

TEST(SensorShareRow, NamesTheIntervalsThatAreMostlyThoseOfSensors) {
  const std::vector<Parameter> parameters{
      {.name = "CL_alpha", .value = 4.0, .sigma = 0.5, .status = ParameterStatus::kIdentified},
      {.name = "CL_q", .value = 2.0, .sigma = 0.3, .status = ParameterStatus::kIdentified}};
  IntervalParts parts{Eigen::Vector2d(0.3, 0.29), Eigen::Vector2d(0.4, 0.05), Eigen::Vector2d(0.0, 0.05), {}};
  const estimation::Evidence row = sensor_share_row("CL", parameters, parts);
  EXPECT_EQ(row.outcome, Outcome::kNotVerified);
  EXPECT_NEAR(row.value, 0.64, 1e-12);
  EXPECT_THAT(says(row), HasSubstr("CL_alpha 64 %"));
  EXPECT_THAT(says(row), Not(HasSubstr("CL_q")));
  EXPECT_FALSE(advice_of(row).empty());
  parts.air_data(0) = 0.1;
  EXPECT_EQ(sensor_share_row("CL", parameters, parts).outcome, Outcome::kPassed);
}

}  // namespace
}  // namespace veridyn::aircraft
