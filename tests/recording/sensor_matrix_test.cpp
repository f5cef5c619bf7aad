#include "veridyn/recording/sensor_matrix.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"

namespace veridyn::recording {
namespace {

using estimation::Outcome;
using ::testing::HasSubstr;

const SensorNames kNames{"accelerometer", "velocity and attitude", {"x", "y", "z"}, "m/s^2"};

SensorMatrix matrix(const Eigen::Matrix3d& gain) {
  SensorMatrix m;
  m.gain = gain;
  m.gain_sigma.setConstant(0.003);
  m.bias_sigma.setConstant(0.01);
  return m;
}

std::string fault(const Eigen::Matrix3d& gain) { return gain_fault(matrix(gain), kNames, 0.02).value_or("none"); }

TEST(GainFault, NamesWhatIsWrong) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  EXPECT_EQ(fault(I), "none");
  EXPECT_THAT(fault(I / kGravity), HasSubstr("g taken for m/s^2"));
  EXPECT_THAT(fault(I / kDegree), HasSubstr("degrees taken for radians"));
  EXPECT_THAT(fault(3.6 * I), HasSubstr("km/h taken for m/s"));
  EXPECT_THAT(fault(1000.0 * I), HasSubstr("a factor of 1000"));
  EXPECT_EQ(fault(Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal()), "the sign of y and z is reversed");
  Eigen::Matrix3d swapped = Eigen::Matrix3d::Zero();
  swapped(0, 1) = 1.0;
  swapped(1, 0) = -1.0;
  swapped(2, 2) = 1.0;
  EXPECT_EQ(fault(swapped), "axis x reads y, axis y reads minus x");
  EXPECT_THAT(fault(Eigen::Vector3d(1.0, 1.1, 1.0).asDiagonal()), HasSubstr("axis y reads 1.1 +- 0.003 times"));
  Eigen::Matrix3d tilted = I;
  tilted(0, 2) = 0.1;
  tilted(2, 0) = -0.1;
  EXPECT_THAT(fault(tilted), HasSubstr("5.7 deg apart"));
}

TEST(GainFault, IsNoneWithinTheErrors) {
  SensorMatrix m = matrix(Eigen::Vector3d(1.0, 1.2, 1.0).asDiagonal());
  m.gain_sigma(1, 1) = 0.1;
  EXPECT_FALSE(gain_fault(m, kNames, 0.02).has_value());
}

TEST(SensorMatrixEvidence, GradesByHowFarItIsOff) {
  const SensorTolerance tolerance{.gain_care = 0.02, .gain_failed = 0.15, .bias_care = 0.1, .bias_failed = 1.0};
  const auto outcomes = [&](double gain, double bias) {
    SensorMatrix m = matrix(Eigen::Vector3d(1.0, 1.0, gain).asDiagonal());
    m.bias(2) = bias;
    const auto rows = sensor_matrix_evidence(m, kNames, tolerance);
    return std::pair(rows.at(0).outcome, rows.at(1).outcome);
  };
  EXPECT_EQ(outcomes(1.01, 0.05), std::pair(Outcome::kPassed, Outcome::kPassed));
  EXPECT_EQ(outcomes(1.05, -0.5), std::pair(Outcome::kCare, Outcome::kCare));
  EXPECT_EQ(outcomes(0.5, 2.0), std::pair(Outcome::kFailed, Outcome::kFailed));
}

TEST(MistakenUnit, IsEmptyForAnOrdinaryScaleError) {
  EXPECT_EQ(mistaken_unit(1.1), "");
  EXPECT_EQ(mistaken_unit(1.94), "knots taken for m/s");
}

}  // namespace
}  // namespace veridyn::recording
