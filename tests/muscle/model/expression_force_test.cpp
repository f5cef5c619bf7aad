#include "veridyn/muscle/model/expression_force.hpp"

#include <gtest/gtest.h>

namespace veridyn::muscle {
namespace {

TEST(ExpressionForces, AreThereWhenOneOfAnyKindIs) {
  EXPECT_TRUE(ExpressionForces{}.empty());
  ExpressionForces forces;
  forces.coordinates.push_back({.name = "c", .coordinate = 0, .force = Expression("q", {"q", "qdot"})});
  EXPECT_FALSE(forces.empty());
  forces = {};
  forces.points.push_back({.name = "p", .force = Expression("d", {"d", "ddot"})});
  EXPECT_FALSE(forces.empty());
  forces = {};
  forces.bushings.emplace_back();
  EXPECT_FALSE(forces.empty());
}

}  // namespace
}  // namespace veridyn::muscle
