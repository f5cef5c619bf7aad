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

TEST(Skeleton, SticksReachAKneeThatItsJointTranslates) {
  Model model = load_model("arm").model();
  Joint& elbow = model.joints[1];
  ASSERT_EQ(elbow.name, "elbow");
  const Eigen::Vector3d moved = elbow.parent_frame.rotation.transpose() * elbow.parent_frame.translation;
  ASSERT_GT(moved.norm(), 0.1);
  const auto sticks_of = [](const Model& of) {
    const Mechanism mechanism(of);
    Kinematics<double> kinematics(mechanism);
    const Eigen::VectorXd q = Eigen::Vector2d(0.4, 1.1);
    update_positions(mechanism, q.data(), kinematics);
    return bones(of, mechanism, kinematics);
  };
  const std::vector<Polyline> before = sticks_of(model);
  // As the knee of gait2392: its frame at the hip, and the way to the knee in functions of its angle.
  elbow.parent_frame.translation.setZero();
  for (int i = 0; i < 3; ++i)
    elbow.translation[static_cast<std::size_t>(i)].function = numerics::PiecewisePolynomial::constant(moved(i));
  const std::vector<Polyline> after = sticks_of(model);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t s = 0; s < after.size(); ++s)
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((after[s].points[i] - before[s].points[i]).norm(), 1e-12);
}

}  // namespace
}  // namespace veridyn::muscle
