#include "veridyn/vehicle/model/longitudinal.hpp"

#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle {
namespace {

TEST(LongitudinalParameters, NameTheNumberThatNoVehicleHas) {
  EXPECT_EQ(inadmissible(LongitudinalParameters{}), "");
  EXPECT_EQ(inadmissible({.front_drive_share = 1.0, .drag_area = 0.0, .rolling_resistance = 0.0}), "");
  EXPECT_EQ(inadmissible({.front_drive_share = 1.1}), "front_drive_share is 1.1; must be between 0 and 1");
  EXPECT_EQ(inadmissible({.front_brake_share = -0.1}), "front_brake_share is -0.1; must be between 0 and 1");
  EXPECT_EQ(inadmissible({.wheel_radius = 0.0}), "wheel_radius is 0; must be > 0");
  EXPECT_EQ(inadmissible({.wheel_inertia = kInfinity}), "wheel_inertia is inf; must be > 0");
  EXPECT_EQ(inadmissible({.drag_area = kNaN}), "drag_area is nan; must be >= 0");
  EXPECT_EQ(inadmissible({.grade = -0.6}), "grade is -0.6 rad; must be between -0.5 and 0.5");
  EXPECT_EQ(inadmissible({.grade = kNaN}), "grade is nan rad; must be between -0.5 and 0.5");
}

}  // namespace
}  // namespace veridyn::vehicle
