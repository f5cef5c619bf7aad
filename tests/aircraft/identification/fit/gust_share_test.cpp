#include "veridyn/aircraft/identification/fit/gust_share.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/aircraft/campaign/campaign.hpp"

namespace veridyn::aircraft {
namespace {

aircraft::testing::Identified flown(std::string_view air, bool gradients, std::string_view aircraft = "unatrap") {
  Progress silent;
  return aircraft::testing::identified(read_study(
      Study::parse(fmt::format("seed = 5\n[subject]\nbuiltin = \"{}\"\n[flight]\nduration = 150\naltitude = 300\n"
                               "turbulence = \"{}\"\ngust_gradients = {}\n",
                               aircraft, air, gradients),
                   "gusts.toml"),
      silent));
}

SensorError share_of(const aircraft::testing::Identified& flight, SensorErrorKind kind) {
  const std::vector<SensorError>& errors = flight.analysis.flights.front().budget.errors;
  return *std::ranges::find(errors, kind, &SensorError::kind);
}

void expect_within_intervals(const aircraft::testing::Identified& flight, Coefficient coefficient) {
  for (const CoefficientResult& result : flight.analysis.coefficients) {
    if (result.coefficient != coefficient) continue;
    for (const estimation::Parameter& p : result.chosen->parameters)
      EXPECT_NEAR(p.value, flight.analysis.truth.at(p.name), p.high95 - p.value) << p.name;
  }
}

// Cm_q came out half as large again, Cm_alpha half as large, both without a doubt.
TEST(GustShare, IsFoundWhereGustsTurnTheAirAndIsNoneWhereTheyDoNot) {
  const aircraft::testing::Identified turning = flown("low_moderate", true), plain = flown("low_moderate", false);
  for (const SensorErrorKind kind : {SensorErrorKind::kGustPitch, SensorErrorKind::kGustYaw}) {
    EXPECT_GT(share_of(turning, kind).mean, 0.5);
    const SensorError none = share_of(plain, kind);
    EXPECT_NEAR(none.mean, 0.0, 0.25);
    EXPECT_LT(none.sigma, 0.3);
  }
  expect_within_intervals(turning, Coefficient::kCm);
}

// Of an aircraft that rolls with p_g hardly any p is against the air: Cl_p -0.10 +- 0.04, identified, where it is
// -0.40.
TEST(GustShare, AcrossTheSpanLeavesNoRollDampingIdentifiedThatIsNotKnown) {
  const auto damping = [](const aircraft::testing::Identified& flight) {
    for (const CoefficientResult& result : flight.analysis.coefficients)
      if (result.coefficient == Coefficient::kCl) return *result.chosen->find("Cl_p");
    return estimation::Parameter{};
  };
  const aircraft::testing::Identified turning = flown("low_light", true, "x8"), plain = flown("low_light", false, "x8");
  EXPECT_GT(share_of(turning, SensorErrorKind::kGustRoll).sigma, 0.2);
  EXPECT_NE(damping(turning).status, estimation::ParameterStatus::kIdentified);
  EXPECT_LT(share_of(plain, SensorErrorKind::kGustRoll).mean, 0.1);
  EXPECT_LT(damping(plain).high95, 0.0);
  expect_within_intervals(plain, Coefficient::kCl);
}

TEST(GustShare, InCalmAirErrorsOfTheReconstructedGustsAreNotTakenForOne) {
  const aircraft::testing::Identified calm = flown("none", false);
  EXPECT_NEAR(share_of(calm, SensorErrorKind::kGustYaw).mean, 0.0, 1.0);
  for (const CoefficientResult& result : calm.analysis.coefficients) {
    if (result.coefficient != Coefficient::kCn) continue;
    const auto column = static_cast<Eigen::Index>(place_of(share_of(calm, SensorErrorKind::kGustYaw)));
    EXPECT_LT(result.sensor_sensitivity.col(column).cwiseAbs().maxCoeff(), 0.2);
  }
}

}  // namespace
}  // namespace veridyn::aircraft
