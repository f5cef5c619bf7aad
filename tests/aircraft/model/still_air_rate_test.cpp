#include "veridyn/aircraft/model/still_air_rate.hpp"

#include <gtest/gtest.h>

#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

// Two derivations of the same motion: forces in wind axes, and accelerometer readings of the same forces in body axes.
TEST(StillAirRate, IsThatOfTheForceEquationsInWindAxes) {
  numerics::RandomStream random(5, "motion");
  for (int i = 0; i < 50; ++i) {
    const double Va = 20.0 + random.normal(), alpha = 0.2 * random.normal(), beta = 0.2 * random.normal();
    WindAxesInput<double> in;
    in.CL = random.normal();
    in.CD = 0.1 * random.normal();
    in.CY = 0.3 * random.normal();
    in.p = random.normal();
    in.q = random.normal();
    in.r = random.normal();
    in.phi = random.normal();
    in.theta = 0.5 * random.normal();
    in.thrust = 10.0 * random.normal();
    in.dynamic_pressure_area = 60.0;
    in.mass = 2.7;
    const double qS = in.dynamic_pressure_area, ca = std::cos(alpha), sa = std::sin(alpha);
    const numerics::Vector3<double> force(in.thrust + qS * (in.CL * sa - in.CD * ca), qS * in.CY,
                                          -qS * (in.CL * ca + in.CD * sa));
    const WindAxesRate<double> found = still_air_rate({.specific_force = force / in.mass,
                                                       .rates = {in.p, in.q, in.r},
                                                       .phi = in.phi,
                                                       .theta = in.theta,
                                                       .Va = Va,
                                                       .alpha = alpha,
                                                       .beta = beta});
    const WindAxesRate<double> expected = wind_axes_rate(Va, alpha, beta, in);
    EXPECT_NEAR(found.Va, expected.Va, 1e-11);
    EXPECT_NEAR(found.alpha, expected.alpha, 1e-11);
    EXPECT_NEAR(found.beta, expected.beta, 1e-11);
  }
}

}  // namespace
}  // namespace veridyn::aircraft
