#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/aircraft/sensors/mapped_log.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::channel;
using aircraft::testing::log_with;
using aircraft::testing::map;

// A climb of 20 deg: (cos 10 deg, 0, sin 10 deg, 0).
TEST(TableQuaternion, GivesTheAttitude) {
  const double c = std::cos(10.0 * kDegree), s = std::sin(10.0 * kDegree);
  for (const auto& [w, x, y, z] :
       {std::array{"q0", "q1", "q2", "q3"}, std::array{"att.q[0]", "att.q[1]", "att.q[2]", "att.q[3]"},
        std::array{"qw", "qx", "qy", "qz"}}) {
    const MappedRecording mapped = map(
        log_with({channel(w, "1", {1, c}), channel(x, "1", {0, 0}), channel(y, "1", {0, s}), channel(z, "1", {0, 0})}));
    ASSERT_TRUE(mapped.recording.has("pitch")) << w;
    EXPECT_NEAR(mapped.recording.at("pitch").value[1], 20.0 * kDegree, 1e-12) << w;
  }
}

TEST(TableQuaternion, IsOfUnitLengthAndBesideNoAngle) {
  const MappedRecording long_one = map(log_with({channel("q0", "1", {1, 2}), channel("q1", "1", {3, 3}),
                                                 channel("q2", "1", {0, 1}), channel("q3", "1", {0, 0})}));
  EXPECT_FALSE(long_one.recording.has("roll"));
  const MappedRecording beside =
      map(log_with({channel("roll", "rad", {0.3, 0.4}), channel("q0", "1", {1, 1}), channel("q1", "1", {0, 0}),
                    channel("q2", "1", {0, 0}), channel("q3", "1", {0, 0})}));
  EXPECT_EQ(beside.recording.at("roll").value[0], 0.3);
  EXPECT_FALSE(beside.recording.has("pitch"));
}

}  // namespace
}  // namespace veridyn::aircraft
