#include "veridyn/muscle/model/muscle_parameters.hpp"

#include <gtest/gtest.h>

namespace veridyn::muscle {
namespace {

// Values of OpenSim's Schutte1993Muscle_Deprecated: the knots of its default splines.
TEST(SchutteCurves, HaveOpenSimsDefaultTendon) {
  const numerics::PiecewisePolynomial tendon = SchutteCurves::default_tendon();
  EXPECT_NEAR(tendon.evaluate(0.0).value, 0.0, 1e-15);
  EXPECT_NEAR(tendon.evaluate(0.00431).value, 0.0435, 1e-14);
  EXPECT_NEAR(tendon.evaluate(0.0123).value, 0.227, 1e-14);
  // Linear to 345 F0 from there: 345.0 - 0.227 over 9.2 - 0.0123, but for the spline's waves at both ends.
  EXPECT_NEAR(tendon.evaluate(9.2).value, 345.0, 1e-9);
  for (double strain = 1e-4; strain < 0.0123; strain += 1e-4) EXPECT_GT(tendon.evaluate(strain).slope, 0.0) << strain;
}

TEST(SchutteCurves, HaveOpenSimsDefaultActiveForce) {
  const numerics::PiecewisePolynomial active = SchutteCurves::default_active();
  EXPECT_NEAR(active.evaluate(0.62875).value, 0.636667, 1e-14);
  EXPECT_NEAR(active.evaluate(1.045).value, 0.993333, 1e-14);
  EXPECT_NEAR(active.evaluate(1.43875).value, 0.246667, 1e-14);
  double greatest = 0.0, at = 0.0;
  for (double length = 0.4; length < 1.8; length += 1e-3) {
    const double force = active.evaluate(length).value;
    if (force <= greatest) continue;
    greatest = force;
    at = length;
  }
  EXPECT_NEAR(at, 1.0, 0.05);
  EXPECT_NEAR(greatest, 1.0, 0.01);
}

}  // namespace
}  // namespace veridyn::muscle
