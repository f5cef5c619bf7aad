#include "veridyn/muscle/model/loop_constraint.hpp"

#include <gtest/gtest.h>

namespace veridyn::muscle {
namespace {

TEST(LoopConstraint, IsNamedAsOpenSimNamesItsKind) {
  LoopConstraint constraint{.name = "foot"};
  EXPECT_EQ(loop_text(constraint), "PointConstraint 'foot'");
  constraint.kind = LoopKind::kWeld;
  EXPECT_EQ(loop_text(constraint), "WeldConstraint 'foot'");
  constraint.kind = LoopKind::kDistance;
  EXPECT_EQ(loop_text(constraint), "ConstantDistanceConstraint 'foot'");
  constraint.kind = LoopKind::kPointOnLine;
  EXPECT_EQ(loop_text(constraint), "PointOnLineConstraint 'foot'");
}

}  // namespace
}  // namespace veridyn::muscle
