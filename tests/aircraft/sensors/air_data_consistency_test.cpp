#include "veridyn/aircraft/sensors/air_data_consistency.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/circling_flight.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::circling;

const std::vector<TimeSpan> kWhole{{0.0, aircraft::testing::kCirclingEnd_s}};

AirDataConsistency consistency_of(const Recording& r, bool airspeed_is_true = true) {
  return air_data_consistency(r, r.at("air_density"), airspeed_is_true, kWhole);
}

TEST(AirDataConsistency, FindsScaleAndWindOverTheHeadings) {
  for (const double scale : {1.0, 1.2}) {
    const AirDataConsistency c = consistency_of(circling({.scale = scale}));
    ASSERT_TRUE(c.airspeed_scale.has_value());
    EXPECT_NEAR(c.airspeed_scale->value, scale, 4.0 * c.airspeed_scale->sigma);
    EXPECT_LT(c.airspeed_scale->sigma, 0.03);
    EXPECT_NEAR(c.wind(0), 4.0, 4.0 * c.wind_sigma(0));
    EXPECT_NEAR(c.wind(1), -2.0, 4.0 * c.wind_sigma(1));
  }
}

TEST(AirDataConsistency, CoversTheScaleInGusts) {
  int covered = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const AirDataConsistency c = consistency_of(circling({.seed = 50 + seed}));
    if (std::abs(c.airspeed_scale->value - 1.0) < 3.0 * c.airspeed_scale->sigma) ++covered;
  }
  EXPECT_GE(covered, 97) << "of 100 within three standard errors";
}

TEST(AirDataConsistency, DoesNotClaimAScaleFromOneHeading) {
  const AirDataConsistency c = consistency_of(circling({.turn_period = 0.0}));
  EXPECT_TRUE(!c.airspeed_scale || c.airspeed_scale->sigma > 0.2);
}

TEST(AirDataConsistency, TakesEquivalentAirspeedAtItsDensity) {
  const AirDataConsistency c = consistency_of(circling({.scale = std::sqrt(1.1 / 1.225)}), false);
  EXPECT_NEAR(c.airspeed_scale->value, 1.0, 4.0 * c.airspeed_scale->sigma);
}

TEST(AirDataConsistency, FindsTheBiasOfAVane) {
  const AirDataConsistency c = consistency_of(circling({.alpha_bias = 3.0 * kDegree}));
  ASSERT_TRUE(c.alpha && c.beta);
  EXPECT_NEAR(c.alpha->bias.value, 3.0 * kDegree, 0.3 * kDegree);
  EXPECT_LT(c.alpha->largest_reading, 15.0 * kDegree);
}

TEST(AirDataConsistency, SaysNothingWithoutAirspeed) {
  const Recording all = circling({});
  Recording rest;
  for (const Channel& channel : all.channels())
    if (channel.name != "airspeed") rest.add(channel);
  const AirDataConsistency c = consistency_of(rest);
  EXPECT_FALSE(c.airspeed_scale || c.alpha || c.beta);
}

}  // namespace
}  // namespace veridyn::aircraft
