#include "veridyn/muscle/path/pose_text.hpp"

#include <gtest/gtest.h>

#include "tests/muscle/path/posed_arm.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

TEST(PoseText, NamesTheCoordinatesThatMoveThePath) {
  const test::PosedArm arm(load_model("arm").model());
  const Eigen::Vector2d q(31.3 * kDegree, -5.0 * kDegree);
  EXPECT_EQ(pose_text(arm.model, arm.paths, arm.model.muscle("biceps_long"), q),
            "shoulder_flexion = 31.3 deg, elbow_flexion = -5 deg");
  EXPECT_EQ(pose_text(arm.model, arm.paths, arm.model.muscle("brachialis"), q), "elbow_flexion = -5 deg");
}

}  // namespace
}  // namespace veridyn::muscle
