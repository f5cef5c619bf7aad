#include "veridyn/vehicle/road/obstacle_road.hpp"

#include <gtest/gtest.h>

#include "tests/vehicle/road/roads.hpp"

namespace veridyn::vehicle {
namespace {

using testing::at;

TEST(ObstacleRoad, HasTheShapesItSays) {
  const ObstacleRoad step({Obstacle::Shape::kStep, 10.0, 0.08, 0.4});
  EXPECT_EQ(step.height(at(9.999)), 0.0);
  EXPECT_NEAR(step.height(at(10.2)), 0.04, 1e-15);
  EXPECT_NEAR(step.height(at(10.1)), 0.04 * (1.0 - std::sqrt(0.5)), 1e-15);
  EXPECT_EQ(step.height(at(50.0)), 0.08);
  const ObstacleRoad edge({Obstacle::Shape::kStep, 10.0, -0.08});
  EXPECT_EQ(edge.height(at(9.999999)), 0.0);
  EXPECT_EQ(edge.height(at(10.0)), -0.08);
  const ObstacleRoad ramp({Obstacle::Shape::kRamp, 5.0, 1.0, 20.0});
  EXPECT_NEAR(ramp.height(at(10.0)), 0.25, 1e-15);
  EXPECT_EQ(ramp.height(at(100.0)), 1.0);
  const ObstacleRoad bump({Obstacle::Shape::kBump, 5.0, 0.1, 2.0});
  EXPECT_NEAR(bump.height(at(6.0)), 0.1, 1e-15);
  EXPECT_NEAR(bump.height(at(5.5)), 0.05, 1e-15);
  EXPECT_EQ(bump.height(at(7.0)), 0.0);
  const ObstacleRoad plank({Obstacle::Shape::kPlank, 5.0, 0.1, 2.0});
  EXPECT_EQ(plank.height(at(5.0)), 0.1);
  EXPECT_EQ(plank.height(at(7.0)), 0.0);
}

TEST(ObstacleRoad, MayLieUnderOneSide) {
  const ObstacleRoad left({Obstacle::Shape::kStep, 1.0, 0.1, 0.0, Obstacle::Side::kLeft});
  EXPECT_EQ(left.height(at(2.0, 0.7)), 0.1);
  EXPECT_EQ(left.height(at(2.0, -0.7)), 0.0);
  const ObstacleRoad right({Obstacle::Shape::kStep, 1.0, 0.1, 0.0, Obstacle::Side::kRight});
  EXPECT_EQ(right.height(at(2.0, 0.7)), 0.0);
  EXPECT_EQ(right.height(at(2.0, -0.7)), 0.1);
}

}  // namespace
}  // namespace veridyn::vehicle
