#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/sensors/mapped_log.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::channel;
using aircraft::testing::log_with;
using aircraft::testing::map;
using ::testing::DoubleNear;
using ::testing::ElementsAre;

// A 30 deg roll to the right: q = (cos 15 deg, sin 15 deg, 0, 0).
TEST(Px4Map, TurnsQuaternionsIntoEulerAngles) {
  const double c = std::cos(15.0 * kDegree);
  const double s = std::sin(15.0 * kDegree);
  const MappedRecording mapped =
      map(log_with({channel("vehicle_attitude.q[0]", "1", {1, c}), channel("vehicle_attitude.q[1]", "1", {0, s}),
                    channel("vehicle_attitude.q[2]", "1", {0, 0}), channel("vehicle_attitude.q[3]", "1", {0, 0})}));
  EXPECT_EQ(mapped.log_kind, "PX4");
  EXPECT_THAT(mapped.recording.at("roll").value, ElementsAre(0.0, DoubleNear(30.0 * kDegree, 1e-14)));
  EXPECT_THAT(mapped.recording.at("pitch").value, ElementsAre(0.0, DoubleNear(0.0, 1e-14)));
}

TEST(Px4Map, ReadsIntegerPositionsAndOldRates) {
  const MappedRecording mapped = map(
      log_with({channel("vehicle_attitude.q[0]", "1", {1, 1}), channel("vehicle_attitude.rollspeed", "1", {0.1, 0.2}),
                channel("vehicle_gps_position.lat", "1", {452206015, 452206016})}));
  EXPECT_THAT(mapped.recording.at("gyro_x").value, ElementsAre(0.1, 0.2));
  EXPECT_NEAR(mapped.recording.at("lat").value[0], 45.2206015 * kDegree, 1e-12);
}

}  // namespace
}  // namespace veridyn::aircraft
