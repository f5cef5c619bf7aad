#include "veridyn/vehicle/model/wheel_guidance.hpp"

#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace veridyn::vehicle {
namespace {

using Wheels = WheelArray<double>;

WheelGuidance<double> guidance(const AxleSuspension& front, const AxleSuspension& rear) {
  VehicleParameters<double> p;
  p.track_f = 1.4;
  p.track_r = 1.6;
  return {p, front, rear, Wheels(6e4, 6e4, 12e4, 12e4), Wheels(2500.0, 2500.0, 2000.0, 2000.0)};
}

TEST(WheelGuidance, DoesNothingUnlessAsked) {
  const WheelGuidance<double> none = guidance({}, {});
  EXPECT_FALSE(none.has_roll_centres() || none.has_curves() || none.steers() || none.yields());
}

TEST(WheelGuidance, SteersByRollAndTowardsTheMiddleInBump) {
  const WheelGuidance<double> g = guidance({.bump_steer = 0.5}, {.roll_steer = 0.08});
  // Left wheels rebound by 10 and 16 mm, right ones bump: a body that leans to the right.
  const Wheels steer = g.steer(Wheels(-0.01, 0.01, -0.016, 0.016));
  EXPECT_NEAR(steer[0], 0.005, 1e-15);  // toe out to the left, toe in to the left
  EXPECT_NEAR(steer[1], 0.005, 1e-15);
  EXPECT_NEAR(steer[2], 0.08 * 0.032 / 1.6, 1e-15);
  EXPECT_EQ(steer[2], steer[3]);
  // In heave toe alone.
  const Wheels heave = g.steer(Wheels::Constant(0.02));
  EXPECT_NEAR(heave[0], -0.01, 1e-15);
  EXPECT_NEAR(heave[1], 0.01, 1e-15);
  EXPECT_EQ(heave[2], 0.0);
}

TEST(WheelGuidance, RollCentresScrubOutwardInBumpAndTakeWeightOffTheTilt) {
  const WheelGuidance<double> g = guidance({.roll_centre = 0.07}, {.roll_centre = 0.2});
  EXPECT_NEAR(g.scrub()[0], 0.1, 1e-15);
  EXPECT_NEAR(g.scrub()[1], -0.1, 1e-15);
  EXPECT_NEAR(g.scrub()[2], 0.25, 1e-15);
  EXPECT_NEAR(g.tilting(), 2.0 * (2500.0 * 0.07 + 2000.0 * 0.2), 1e-10);
}

TEST(WheelGuidance, RefusesAWheelThatGivesWayAsFastAsItsForceGrows) {
  EXPECT_EQ(why([] { (void)guidance({}, {.compliance_steer = 1e-5}); }),
            "vehicle: compliance_steer_r is 1e-05 rad/N; times the tyre's cornering stiffness it must be between -0.9 "
            "and 0.9");
  EXPECT_TRUE(guidance({.compliance_steer = 1e-5}, {}).yields());
}

}  // namespace
}  // namespace veridyn::vehicle
