#include "veridyn/recording/sensor_matrix.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"

namespace veridyn::recording {
namespace {

using estimation::Outcome;
using ::testing::HasSubstr;

using estimation::Cause;
using estimation::Check;

const SensorNames kNames{"accelerometer",    "velocity and attitude",   {"x", "y", "z"},
                         Check::kSensorGain, Check::kAccelerometerBias, 1.0,
                         parse_unit("m/s^2")};

SensorMatrix matrix(const Eigen::Matrix3d& gain) {
  SensorMatrix m;
  m.gain = gain;
  m.gain_sigma.setConstant(0.003);
  m.bias_sigma.setConstant(0.01);
  return m;
}

GainFault fault(const Eigen::Matrix3d& gain) { return gain_fault(matrix(gain), kNames, 0.02).value_or(GainFault{}); }

TEST(GainFault, FindsTheCause) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  EXPECT_EQ(fault(I).cause, Cause::kNone);
  // Of an accelerometer no speed and no angle is a unit.
  EXPECT_EQ(fault(3.6 * I).cause, Cause::kScale);
  for (const auto& [factor, unit] : {std::pair{1.0 / kGravity, "g taken for m/s^2"},
                                     {1.0 / 0.3048, "ft/s^2 taken for m/s^2"},
                                     {1000.0, "mm/s^2 taken for m/s^2"}}) {
    EXPECT_EQ(fault(factor * I).cause, Cause::kUnit);
    EXPECT_EQ(fault(factor * I).unit, unit);
    EXPECT_NEAR(fault(factor * I).factor, factor, 1e-12);
  }
  const GainFault signs = fault(Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal());
  EXPECT_EQ(signs.cause, Cause::kSign);
  EXPECT_EQ(signs.axes, "y and z");
  Eigen::Matrix3d swapped = Eigen::Matrix3d::Zero();
  swapped(0, 1) = 1.0;
  swapped(1, 0) = -1.0;
  swapped(2, 2) = 1.0;
  EXPECT_EQ(fault(swapped).cause, Cause::kAxis);
  EXPECT_EQ(fault(swapped).axes, "x reads y, y reads minus x");
  const GainFault scale = fault(Eigen::Vector3d(1.0, 1.1, 1.0).asDiagonal());
  EXPECT_EQ(scale.cause, Cause::kScale);
  EXPECT_EQ(scale.axes, "y");
  EXPECT_NEAR(scale.factor, 1.1, 1e-12);
  Eigen::Matrix3d tilted = I;
  tilted(0, 2) = 0.1;
  tilted(2, 0) = -0.1;
  EXPECT_EQ(fault(tilted).cause, Cause::kPlace);
}

TEST(GainFault, IsNoneWithinTheErrorsAndOfAxesThatRest) {
  SensorMatrix m = matrix(Eigen::Vector3d(1.0, 1.2, 1.0).asDiagonal());
  EXPECT_TRUE(gain_fault(m, kNames, 0.02).has_value());
  m.moved[1] = false;
  EXPECT_FALSE(gain_fault(m, kNames, 0.02).has_value());
  m.moved[1] = true;
  m.gain_sigma(1, 1) = 0.1;
  EXPECT_FALSE(gain_fault(m, kNames, 0.02).has_value());
}

TEST(SensorMatrixEvidence, GradesByHowFarItIsOff) {
  const auto outcomes = [&](double gain, double bias) {
    SensorMatrix m = matrix(Eigen::Vector3d(1.0, 1.0, gain).asDiagonal());
    m.bias(2) = bias;
    const auto rows = sensor_matrix_evidence(m, kNames);
    return std::pair(rows.at(0).outcome, rows.at(1).outcome);
  };
  EXPECT_EQ(outcomes(1.01, 0.05), std::pair(Outcome::kPassed, Outcome::kPassed));
  EXPECT_EQ(outcomes(1.05, -0.5), std::pair(Outcome::kCare, Outcome::kCare));
  EXPECT_EQ(outcomes(0.5, 2.0), std::pair(Outcome::kFailed, Outcome::kFailed));
}

TEST(SensorMatrixEvidence, SaysWhichAxesItCannotVerify) {
  SensorMatrix m = matrix(Eigen::Vector3d(0.05, 1.0, 1.0).asDiagonal());
  m.moved[0] = false;
  const auto rows = sensor_matrix_evidence(m, kNames);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].outcome, Outcome::kPassed);
  EXPECT_EQ(rows[1].outcome, Outcome::kNotVerified);
  EXPECT_EQ(rows[1].cause, Cause::kExcitation);
  EXPECT_THAT(says(rows[1]), HasSubstr("x of the accelerometer moved too little"));
}

}  // namespace
}  // namespace veridyn::recording
