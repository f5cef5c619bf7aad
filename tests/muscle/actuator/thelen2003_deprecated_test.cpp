#include "veridyn/muscle/actuator/thelen2003_deprecated.hpp"

#include <gtest/gtest.h>

#include "tests/muscle/actuator/curve_checks.hpp"
#include "tests/muscle/arm26_muscles.hpp"
#include "veridyn/muscle/actuator/thelen2003.hpp"

namespace veridyn::muscle {
namespace {

TEST(Thelen2003Deprecated, DiffersFromThelen2003InItsFiveKnownWays) {
  const Thelen2003Deprecated old;
  const Thelen2003 now(arm26_thelen());
  // The tendon: slope 1.712/e0 beyond a toe of force 1/3 at 0.609 e0, 0.001 of the length at all lengths.
  EXPECT_NEAR(old.tendon_force(0.9), 0.0009, 1e-16);
  const double toe = 1.0 + 0.609 * 0.033;
  EXPECT_NEAR(old.tendon_force(toe), 1.0 / 3.0 + 0.001 * toe, 1e-14);
  EXPECT_NEAR(old.tendon_force(1.05), 1.0 / 3.0 + 1.712 / 0.033 * (1.05 - toe) + 0.00105, 1e-13);
  // Passive force is e^-k at l = 1 and goes on straight after its strain.
  EXPECT_NEAR(old.passive_force(1.0), 0.018315638888734, 1e-14);
  EXPECT_NEAR(old.passive_force(1.6), 1.0, 1e-14);
  EXPECT_NEAR(old.passive_force(1.9), 1.0 + 4.0 / 0.6 * 0.3, 1e-13);
  EXPECT_EQ(old.active_length(1.23), now.active_length(1.23));
  // v = (F - A)/(b + 0.05), with speeds of Vmax0 + a (Vmax - Vmax0).
  const double a = 0.6, fL = 0.9, A = a * fL;
  EXPECT_NEAR(old.velocity(a, fL, 0.3, 0.0), (0.3 - A) / (A + 0.3 / 0.3 + 0.05), 1e-15);
  EXPECT_NEAR(old.velocity(a, fL, 0.7, 0.0), (0.7 - A) / ((2.0 + 2.0 / 0.3) * (A * 1.8 - 0.7) / 0.8 + 0.05), 1e-14);
  EXPECT_NEAR(old.velocity_unit(a, 10.0), 8.0, 1e-15);
  EXPECT_NEAR(old.activation_rate(1.0, 0.1, 0.01, 0.04), 90.0, 1e-12);
  EXPECT_NEAR(old.activation_rate(0.0, 0.1, 0.01, 0.04), -2.5, 1e-12);
}

TEST(Thelen2003Deprecated, VelocityIsTheInverseOfForce) {
  expect_velocity_inverts_force(Thelen2003Deprecated(), 0.0, 3.0);
}

TEST(Thelen2003Deprecated, SlopesAndEnergiesBelongToTheForces) { expect_consistent(Thelen2003Deprecated()); }

}  // namespace
}  // namespace veridyn::muscle
