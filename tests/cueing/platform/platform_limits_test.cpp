#include "veridyn/cueing/platform/platform_limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

using ::testing::ElementsAre;

TEST(PlatformLimits, NamesTheAxesThatMoveInOrder) {
  EXPECT_THAT(three_axis_limits().moving_axes(),
              ElementsAre(PlatformAxis::kHeave, PlatformAxis::kRoll, PlatformAxis::kPitch));
  EXPECT_THAT(hexapod_limits().moving_axes(), ::testing::ElementsAreArray(kAllPlatformAxes));
  EXPECT_TRUE(PlatformLimits{}.moving_axes().empty());
}

TEST(PlatformLimits, RefusesAPlatformThatCannotMove) {
  EXPECT_THROW(PlatformLimits{}.validate(), InputError);
  PlatformLimits limits = three_axis_limits();
  limits.validate();
  limits[PlatformAxis::kYaw].jerk = 0.0;
  EXPECT_THROW(limits.validate(), InputError);
}

}  // namespace
}  // namespace veridyn::cueing
