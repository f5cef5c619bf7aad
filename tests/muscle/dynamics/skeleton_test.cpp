#include "veridyn/muscle/dynamics/skeleton.hpp"

#include <gtest/gtest.h>

#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

TEST(Skeleton, SticksOfTheArmMeetInTheElbowAndEndBeyondTheMassCentre) {
  const Model model = load_model("arm").model();
  const Mechanism mechanism(model);
  Kinematics<double> kinematics(mechanism);
  const Eigen::VectorXd q = Eigen::Vector2d(0.4, 1.1);
  update_positions(mechanism, q.data(), kinematics);
  const std::vector<Polyline> sticks = bones(model, mechanism, kinematics);
  ASSERT_EQ(sticks.size(), 2u);
  EXPECT_EQ(sticks[1].name, "forearm");
  EXPECT_NEAR((sticks[0].points.back() - sticks[1].points.front()).norm(), 0.0, 1e-14);
  const int forearm = model.body("forearm");
  const Eigen::Vector3d center = body_pose(mechanism, kinematics, forearm) * model.bodies[forearm].mass_center;
  EXPECT_NEAR((0.5 * (sticks[1].points.front() + sticks[1].points.back()) - center).norm(), 0.0, 1e-14);
}

}  // namespace
}  // namespace veridyn::muscle
