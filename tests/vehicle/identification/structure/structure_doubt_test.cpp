#include "veridyn/vehicle/identification/structure/structure_doubt.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::vehicle {
namespace {

using ::testing::HasSubstr;

/// C_f and I_z with independent standard errors.
VehicleEstimate estimate(double C_f, double I_z) {
  const auto parameter = [](const char* name, double value, double sigma) {
    estimation::Parameter p;
    p.name = name;
    p.value = value;
    p.sigma = sigma;
    return p;
  };
  VehicleEstimate e;
  e.method = VehicleMethod::kOutputError;
  e.usable = true;
  e.parameters = {parameter("C_f", C_f, 300.0), parameter("I_z", I_z, 20.0)};
  e.covariance = Eigen::Vector2d(300.0 * 300.0, 20.0 * 20.0).asDiagonal();
  e.degrees_of_freedom = 1e4;
  for (estimation::Parameter& p : e.parameters) estimation::set_interval(p, e.degrees_of_freedom);
  return e;
}

TEST(StructureDoubt, AnIntervalReachesToWhatTheOtherStructureGives) {
  const VehicleEstimate taken = estimate(60000.0, 2000.0), other = estimate(58000.0, 2100.0);
  const std::vector<StructureDoubt> doubts{structure_doubt(DriveStructure::kRelaxation, 0.36, other, taken)};
  EXPECT_NEAR(doubt_of(doubts, "C_f"), 0.6 * 2000.0, 1e-9);
  EXPECT_NEAR(doubt_of(doubts, "I_z"), 0.6 * 100.0, 1e-9);
  EXPECT_EQ(doubt_of(doubts, "mu"), 0.0);
  const VehicleEstimate widened = with_doubt(taken, doubts, 0.05);
  EXPECT_NEAR(widened.parameters[0].sigma, std::hypot(300.0, 1200.0), 1e-9);
  EXPECT_NEAR(widened.parameters[1].sigma, std::hypot(20.0, 60.0), 1e-9);
  EXPECT_NEAR(widened.covariance(0, 1), 0.36 * -2000.0 * 100.0, 1e-9);
  EXPECT_LT(widened.parameters[0].low95, other.parameters[0].value);
  EXPECT_GT(taken.parameters[0].low95, other.parameters[0].value);
  EXPECT_EQ(widened.parameters[0].value, taken.parameters[0].value);
}

TEST(StructureDoubt, TheRowSaysWhenMostOfAnIntervalIsDoubt) {
  const VehicleEstimate taken = estimate(60000.0, 2000.0);
  EXPECT_FALSE(doubt_row({}, taken).has_value());
  const auto row_of = [&](double difference) {
    const std::vector<StructureDoubt> doubts{
        structure_doubt(DriveStructure::kRelaxation, 0.5, estimate(60000.0 + difference, 2000.0), taken)};
    return doubt_row(doubts, with_doubt(taken, doubts, 0.05));
  };
  const auto small = row_of(100.0), large = row_of(-2000.0);
  ASSERT_TRUE(small && large);
  EXPECT_EQ(small->outcome, estimation::Outcome::kPassed);
  EXPECT_EQ(large->outcome, estimation::Outcome::kNotVerified);
  EXPECT_THAT(says(*large), HasSubstr("roll and relaxation (probability 0.5)"));
  EXPECT_THAT(says(*large), HasSubstr("C_f by 2.4 %"));
  EXPECT_FALSE(advice_of(*large).empty());
}

}  // namespace
}  // namespace veridyn::vehicle
