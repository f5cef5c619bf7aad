#include "veridyn/io/ulog/px4_units.hpp"

#include <gtest/gtest.h>

namespace veridyn::io {
namespace {

// Units from the comments of PX4's msg/*.msg.
TEST(Px4Units, AreThoseOfTheMessageDefinitions) {
  EXPECT_EQ(px4_unit("sensor_combined", "gyro_rad").unit, "rad/s");
  EXPECT_EQ(px4_unit("vehicle_local_position", "vx").unit, "m/s");
  EXPECT_EQ(px4_unit("sensor_mag", "x").unit, "gauss");
  const Px4Unit latitude = px4_unit("vehicle_gps_position", "lat");
  EXPECT_EQ(latitude.unit, "deg");
  EXPECT_DOUBLE_EQ(latitude.scale, 1e-7);
}

TEST(Px4Units, FollowTheEndingOfOtherFields) {
  EXPECT_EQ(px4_unit("airspeed", "true_airspeed_m_s").unit, "m/s");
  EXPECT_EQ(px4_unit("any", "accel_m_s2").unit, "m/s^2");
  EXPECT_EQ(px4_unit("any", "pressure_pa").unit, "Pa");
  EXPECT_EQ(px4_unit("any", "_pa").unit, "1");
  EXPECT_EQ(px4_unit("any", "count").unit, "1");
}

}  // namespace
}  // namespace veridyn::io
