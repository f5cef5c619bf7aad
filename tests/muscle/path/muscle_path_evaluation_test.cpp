#include "veridyn/muscle/path/muscle_path_evaluation.hpp"

#include <gtest/gtest.h>

#include "tests/muscle/path/posed_arm.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using test::PosedArm;

TEST(MusclePaths, SpeedsAreTheRatesOfTheLengths) {
  PosedArm arm(load_model("arm").model());
  const Eigen::VectorXd q = Eigen::Vector2d(0.3, 1.1), qdot = Eigen::Vector2d(0.7, -2.0);
  std::vector<double> speeds(6);
  arm.pose(q);
  arm.paths.speeds(arm.workspace, qdot.data(), speeds.data());
  arm.pose(q + 1e-6 * qdot);
  const std::vector<double> after = arm.workspace.length;
  arm.pose(q - 1e-6 * qdot);
  for (std::size_t m = 0; m < 6; ++m) EXPECT_NEAR(speeds[m], (after[m] - arm.workspace.length[m]) / 2e-6, 1e-6);
}

TEST(MusclePaths, ThatWrapAndAreNotAskedForStayAsTheyWere) {
  PosedArm arm(load_model("arm").model());
  arm.pose_deg(20.0, 60.0);
  const std::vector<double> all = arm.workspace.length;
  arm.pose_deg(40.0, 90.0);
  const std::vector<double> elsewhere = arm.workspace.length;
  const std::vector<std::uint8_t> left_out{0, 1, 0, 1, 1, 0};
  const Eigen::VectorXd back = Eigen::Vector2d(20.0 * kDegree, 60.0 * kDegree);
  update_positions(arm.mechanism, back.data(), arm.kinematics);
  arm.paths.evaluate(arm.kinematics, back.data(), arm.workspace, left_out);
  int stayed = 0;
  for (std::size_t m = 0; m < 6; ++m) {
    const bool stays = left_out[m] != 0 && !arm.model.muscles[m].wraps.empty();
    stayed += stays ? 1 : 0;
    EXPECT_EQ(arm.workspace.length[m], stays ? elsewhere[m] : all[m]) << arm.model.muscles[m].name();
  }
  EXPECT_GT(stayed, 0);
}

}  // namespace
}  // namespace veridyn::muscle
