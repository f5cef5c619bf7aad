#include "veridyn/cueing/washout/moving_origin_washout.hpp"

#include <gtest/gtest.h>

#include "tests/cueing/washout/pushed.hpp"

namespace veridyn::cueing {
namespace {

using testing_support::pushed;

TEST(MovingOriginWashout, MakesRoomOnTheOtherSideOfAStrongPush) {
  MovingOriginWashout washout(MovingOriginDesign{}, built_in_platform("hexapod"));
  washout.reset(pushed(0.0));
  for (int k = 0; k < 150; ++k) washout.step(pushed(5.0), 0.01);
  EXPECT_LT(washout.origin().x(), -0.005);
  for (int k = 0; k < 6000; ++k) washout.step(pushed(0.0), 0.01);
  EXPECT_NEAR(washout.origin().x(), 0.0, 1e-4);
  MovingOriginWashout calm(MovingOriginDesign{}, built_in_platform("hexapod"));
  calm.reset(pushed(0.0));
  for (int k = 0; k < 300; ++k) calm.step(pushed(0.2), 0.01);
  EXPECT_EQ(calm.origin().x(), 0.0);
}

}  // namespace
}  // namespace veridyn::cueing
