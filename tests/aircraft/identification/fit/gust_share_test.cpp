#include "veridyn/aircraft/identification/fit/gust_share.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/aircraft/campaign/campaign.hpp"

namespace veridyn::aircraft {
namespace {

aircraft::testing::Identified flown(std::string_view air, bool gradients) {
  Progress silent;
  return aircraft::testing::identified(read_study(
      Study::parse(fmt::format("seed = 5\n[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 150\naltitude = "
                               "300\nturbulence = \"{}\"\ngust_gradients = {}\n",
                               air, gradients),
                   "gusts.toml"),
      silent));
}

SensorError turn_of(const aircraft::testing::Identified& flight) {
  const std::vector<SensorError>& errors = flight.analysis.flights.front().budget.errors;
  return *std::ranges::find(errors, SensorErrorKind::kGustTurn, &SensorError::kind);
}

// Cm_q came out half as large again, Cm_alpha half as large, both without a doubt.
TEST(GustShare, IsFoundWhereGustsTurnTheAirAndIsNoneWhereTheyDoNot) {
  const aircraft::testing::Identified turning = flown("low_moderate", true);
  const SensorError all = turn_of(turning), none = turn_of(flown("low_moderate", false));
  EXPECT_GT(all.mean, 0.5);
  EXPECT_NEAR(none.mean, 0.0, 0.25);
  EXPECT_LT(none.sigma, 0.3);
  for (const CoefficientResult& result : turning.analysis.coefficients) {
    if (result.coefficient != Coefficient::kCm) continue;
    for (const estimation::Parameter& p : result.chosen->parameters)
      EXPECT_NEAR(p.value, turning.analysis.truth.at(p.name), p.high95 - p.value) << p.name;
  }
}

TEST(GustShare, InCalmAirErrorsOfTheReconstructedGustsAreNotTakenForOne) {
  const aircraft::testing::Identified calm = flown("none", false);
  EXPECT_NEAR(turn_of(calm).mean, 0.0, 1.0);
  for (const CoefficientResult& result : calm.analysis.coefficients) {
    if (result.coefficient != Coefficient::kCn) continue;
    const Eigen::Index column = static_cast<Eigen::Index>(place_of(turn_of(calm)));
    EXPECT_LT(result.sensor_sensitivity.col(column).cwiseAbs().maxCoeff(), 0.2);
  }
}

}  // namespace
}  // namespace veridyn::aircraft
