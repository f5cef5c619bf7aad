#include "veridyn/muscle/actuator/degroote_fregly2016.hpp"

#include <gtest/gtest.h>

#include "tests/muscle/actuator/curve_checks.hpp"

namespace veridyn::muscle {
namespace {

TEST(DeGrooteFregly2016, MatchesPrintedValues) {
  const DeGrooteFregly2016 c;
  EXPECT_NEAR(c.active_length(0.8), 0.836439566115, 1e-12);
  EXPECT_NEAR(c.active_length(1.2), 0.793689718066, 1e-12);
  EXPECT_NEAR(c.active_length(1.0), 1.0, 1e-14);
  EXPECT_NEAR(c.passive_force(1.0), 0.0182288238201, 1e-13);
  EXPECT_NEAR(c.passive_force(1.5), 0.513374088169, 1e-12);
  EXPECT_NEAR(c.passive_force(0.2), 0.0, 1e-16);
  EXPECT_NEAR(c.tendon_force(1.02), 0.215568624601, 1e-12);
  EXPECT_NEAR(c.tendon_force(1.049), 1.0, 1e-13);
  EXPECT_NEAR(c.tendon_force(1.0), 0.0, 1e-16);
  EXPECT_NEAR(c.force_velocity(-0.5), 0.234036393549, 1e-12);
  EXPECT_NEAR(c.force_velocity(0.0), 1.0, 1e-14);
  EXPECT_NEAR(c.force_velocity(0.5), 1.58842340125, 1e-11);
  EXPECT_NEAR(c.force_velocity(1.0), 1.79434296356, 1e-11);
}

TEST(DeGrooteFregly2016, VelocityIsTheInverseOfForce) {
  expect_velocity_inverts_force(DeGrooteFregly2016(), 0.0, 1.0);
  expect_velocity_inverts_force(DeGrooteFregly2016(), 0.05, 2.0);
}

TEST(DeGrooteFregly2016, SlopesAndEnergiesBelongToTheForces) { expect_consistent(DeGrooteFregly2016()); }

}  // namespace
}  // namespace veridyn::muscle
