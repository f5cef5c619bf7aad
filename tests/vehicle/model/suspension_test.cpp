#include "veridyn/vehicle/model/suspension.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::vehicle {
namespace {

TEST(Suspension, NamesTheNumberThatNoAxleHas) {
  EXPECT_EQ(inadmissible(AxleSuspension{}, 'f'), "");
  EXPECT_EQ(inadmissible({.roll_centre = 0.1, .roll_steer = -0.05, .bump_steer = 0.3, .compliance_steer = -5e-6}, 'r'),
            "");
  EXPECT_EQ(inadmissible({.roll_centre = 60.0}, 'f'), "roll_centre_f is 60 m; must be between -5 and 5");
  EXPECT_EQ(inadmissible({.roll_steer = std::nan("")}, 'r'), "roll_steer_r is nan rad/rad; must be between -2 and 2");
  EXPECT_EQ(inadmissible({.bump_steer = -200.0}, 'f'), "bump_steer_f is -200 rad/m; must be between -100 and 100");
  EXPECT_EQ(inadmissible({.compliance_steer = 0.3}, 'f'),
            "compliance_steer_f is 0.3 rad/N; must be between -0.1 and 0.1");
}

TEST(Suspension, NamesTheAirThatThereIsNot) {
  EXPECT_EQ(inadmissible(AerodynamicLift{.area_f = 0.1, .area_r = -0.4}), "");
  EXPECT_EQ(inadmissible(AerodynamicLift{.area_r = std::nan("")}),
            "lift_area_r is nan m^2; must be between -100 and 100");
  EXPECT_EQ(inadmissible(AerodynamicLift{.air_density = -1.0}),
            "air_density is -1 kg/m^3; must be between 0 and 10000");
}

}  // namespace
}  // namespace veridyn::vehicle
