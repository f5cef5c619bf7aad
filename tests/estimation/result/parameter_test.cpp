#include "veridyn/estimation/result/parameter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::estimation {
namespace {

Parameter parameter(double value, double sigma, ParameterStatus status = ParameterStatus::kIdentified) {
  return {.name = "CL_alpha", .value = value, .sigma = sigma, .status = status};
}

TEST(SetInterval, IsThatOfStudentsT) {
  // Table of Student's t: 2.228 for 10 degrees of freedom at 97.5 %.
  Parameter p = parameter(5.0, 0.5);
  set_interval(p, 10.0);
  EXPECT_NEAR(p.low95, 5.0 - 2.228 * 0.5, 1e-3);
  EXPECT_NEAR(p.high95, 5.0 + 2.228 * 0.5, 1e-3);
  EXPECT_DOUBLE_EQ(p.t, 10.0);
}

TEST(SetInterval, EndsAtZeroWhereTheTestIsJustSignificant) {
  Parameter p = parameter(2.2281388519649385, 1.0);
  set_interval(p, 10.0);
  EXPECT_NEAR(p.low95, 0.0, 1e-9);
  EXPECT_NEAR(p.p_value, 0.05, 1e-9);
}

TEST(SetInterval, LeavesNothingToTestOfAFixedParameter) {
  Parameter p = parameter(2.0, 0.0, ParameterStatus::kFixed);
  set_interval(p, 10.0);
  EXPECT_TRUE(std::isnan(p.p_value));
  EXPECT_DOUBLE_EQ(p.low95, 2.0);
  EXPECT_DOUBLE_EQ(p.high95, 2.0);
}

TEST(SetInterval, IsEndlessForWhatIsNotDetermined) {
  Parameter p = parameter(2.0, kInfinity);
  set_interval(p, 10.0);
  EXPECT_DOUBLE_EQ(p.high95, kInfinity);
  EXPECT_DOUBLE_EQ(p.low95, -kInfinity);
  EXPECT_DOUBLE_EQ(p.p_value, 1.0);
}

TEST(Widen, StretchesTheIntervalByTheRootOfTheVarianceFactor) {
  Parameter p = parameter(5.0, 1.0);
  set_interval(p, 10.0);
  const double half = p.high95 - p.value;
  widen(p, 4.0, 10.0, 0.05);
  EXPECT_DOUBLE_EQ(p.sigma, 2.0);
  EXPECT_NEAR(p.high95 - p.value, 2.0 * half, 1e-12);
  EXPECT_EQ(p.status, ParameterStatus::kIdentified);  // t = 2.5, p = 0.031
  widen(p, 4.0, 10.0, 0.05);
  EXPECT_EQ(p.status, ParameterStatus::kInsignificant);
  const Parameter before = p;
  widen(p, 0.5, 10.0, 0.05);
  EXPECT_DOUBLE_EQ(p.sigma, before.sigma);
}

}  // namespace
}  // namespace veridyn::estimation
