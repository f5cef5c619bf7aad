#include "veridyn/muscle/actuator/schutte1993.hpp"

#include <gtest/gtest.h>

#include "tests/muscle/actuator/curve_checks.hpp"

namespace veridyn::muscle {
namespace {

TEST(Schutte1993, CurvesPassThroughTheirPoints) {
  const Schutte1993 c;
  EXPECT_EQ(c.tendon_force(0.9), 0.0);
  EXPECT_NEAR(c.tendon_force(1.00431), 0.0435, 1e-14);
  EXPECT_NEAR(c.tendon_force(1.0123), 0.227, 1e-14);
  EXPECT_NEAR(c.active_length(0.71875), 0.856667, 1e-14);
  EXPECT_NEAR(c.active_length(1.2175), 0.77, 1e-14);
  EXPECT_NEAR(c.passive_force(1.5), 1.0, 1e-14);
  EXPECT_NEAR(c.passive_force(1.0), std::exp(-4.0), 1e-16);
  SchutteCurves with_passive;
  with_passive.passive = numerics::PiecewisePolynomial::linear(2.0, -2.0);
  EXPECT_NEAR(Schutte1993(with_passive).passive_force(1.3), 0.6, 1e-15);
}

// The quadratic that OpenSim solves for the velocity, from the force that the header gives.
TEST(Schutte1993, VelocityIsTheInverseOfForceWhereThatIsNoPush) {
  const Schutte1993 c;
  int compared = 0;
  for (const double a : {0.01, 0.2, 1.0})
    for (const double fL : {0.1, 0.8, 1.0})
      for (double v = -1.0; v <= 3.0; v += 0.0371) {
        const double F = c.active_force(a, fL, v);
        if (F < 0.0) continue;
        ++compared;
        EXPECT_NEAR(c.velocity(a, fL, F, 0.0), v, 1e-12) << a << " " << fL;
      }
  EXPECT_GT(compared, 700);
  // A push counts as no force.
  EXPECT_EQ(c.velocity(0.5, 1.0, -0.3, 0.0), c.velocity(0.5, 1.0, 0.0, 0.0));
  EXPECT_NEAR(c.active_force(0.6, 0.5, 0.0), 0.3, 1e-16);
  // Both branches meet with a continuous force at rest; lengthening tends to 1.4 A + d v.
  EXPECT_NEAR(c.active_force(0.6, 0.5, 1e-12), 0.3, 1e-10);
  EXPECT_NEAR(c.active_force(1.0, 1.0, 1e6) - 0.1 * 1e6, 1.4, 1e-6);
}

TEST(Schutte1993, ActivationRisesByItsTwoFactors) {
  const Schutte1993 c;
  // OpenSim: (u - a) (activation1 u + activation2)/time_scale upwards, (u - a) activation2/time_scale downwards.
  const double scale = 0.1, one = 7.667, two = 1.459854;
  const double rise = scale / (one + two), fall = scale / two;
  EXPECT_NEAR(c.activation_rate(0.7, 0.2, rise, fall), 0.5 * (one * 0.7 + two) / scale, 1e-12);
  EXPECT_NEAR(c.activation_rate(0.1, 0.4, rise, fall), -0.3 * two / scale, 1e-13);
}

TEST(Schutte1993, SlopesAndEnergiesBelongToTheForces) { expect_consistent(Schutte1993()); }

}  // namespace
}  // namespace veridyn::muscle
