#include "veridyn/muscle/dynamics/mechanism.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/muscle/dynamics/model_trees.hpp"
#include "tests/muscle/reference_table.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

using numerics::RandomStream;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// The joint's definition spelled out, body by body: an independent route to the poses.
Placement pose_by_definition(const Model& model, const Eigen::VectorXd& q, int body) {
  if (body == 0) return {};
  for (const Joint& joint : model.joints) {
    if (joint.child != body) continue;
    const auto amount = [&](const TransformAxis& a) {
      if (!a.several.empty()) {
        std::vector<double> x;
        for (const int c : a.several) x.push_back(q(c));
        return a.function_of_several.value(x.data());
      }
      return a.function.evaluate(a.coordinate < 0 ? 0.0 : q(a.coordinate)).value;
    };
    Placement motion;
    for (const TransformAxis& a : joint.rotation) {
      motion.rotation = motion.rotation * Eigen::AngleAxisd(amount(a), a.axis).toRotationMatrix();
    }
    for (const TransformAxis& a : joint.translation) motion.translation += amount(a) * a.axis;
    return pose_by_definition(model, q, joint.parent) * joint.parent_frame * motion * joint.child_frame.inverse();
  }
  ADD_FAILURE() << "body without joint";
  return {};
}

TEST(Mechanism, PosesAreThoseOfTheJointsDefinition) {
  RandomStream random(1, "poses");
  for (int trial = 0; trial < 20; ++trial) {
    const Model model = test::random_tree(10, random);
    const Mechanism mechanism(model);
    Kinematics<double> k(mechanism);
    const Eigen::VectorXd q = test::random_state(model.coordinates.size(), 1.8, random);
    update_positions(mechanism, q.data(), k);
    for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
      const Placement expected = pose_by_definition(model, q, b);
      const Pose<double> pose = body_pose(mechanism, k, b);
      EXPECT_LT((pose.rotation - expected.rotation).norm(), 1e-13) << "body " << b;
      EXPECT_LT((pose.position - expected.translation).norm(), 1e-13) << "body " << b;
    }
  }
}

/// A random tree whose joints of several coordinates turn about their first axis, too, with all of them.
Model tree_of_several(RandomStream& random) {
  Model model = test::random_tree(8, random);
  for (Joint& joint : model.joints) {
    if (joint.rotation[1].several.empty()) continue;
    joint.rotation[0].coordinate = -1;
    joint.rotation[0].several = joint.translation[0].several;
    joint.rotation[0].function_of_several = joint.translation[0].function_of_several;
  }
  return model;
}

// Jets along each coordinate: a point of every body must move with the column if its link is beyond the joint, else
// rest.
TEST(Mechanism, ColumnsAreTheDerivativesOfThePoses) {
  using Jet = ceres::Jet<double, 1>;
  RandomStream random(2, "columns");
  for (int trial = 0; trial < 10; ++trial) {
    const Model model = tree_of_several(random);
    const Mechanism mechanism(model);
    Kinematics<double> k(mechanism);
    Kinematics<Jet> derivative(mechanism);
    const Eigen::VectorXd q = test::random_state(model.coordinates.size(), 1.8, random);
    update_positions(mechanism, q.data(), k);
    for (int c = 0; c < mechanism.coordinates(); ++c) {
      Eigen::Matrix<Jet, Eigen::Dynamic, 1> qj = q.cast<Jet>();
      qj(c).v[0] = 1.0;
      update_positions(mechanism, qj.data(), derivative);
      for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
        const Eigen::Vector3d local(0.1, -0.3, 0.2);
        const Eigen::Vector3d point = body_pose(mechanism, k, b) * local;
        const Vector3<Jet> moving = body_pose(mechanism, derivative, b) * local;
        const bool moves = mechanism.moves(c, mechanism.body(b).link);
        const Eigen::Vector3d expected = moves ? k.columns[c].at(point) : Eigen::Vector3d::Zero();
        for (int i = 0; i < 3; ++i) {
          EXPECT_NEAR(moving(i).a, point(i), 1e-13);
          EXPECT_NEAR(moving(i).v[0], expected(i), 1e-13) << "coordinate " << c << " body " << b;
        }
      }
    }
  }
}

// A point's velocity and acceleration from second-order Taylor arithmetic in time against velocity and bias.
TEST(Mechanism, VelocitiesAndBiasAreTheTimeDerivativesOfThePoses) {
  using Jet = ceres::Jet<double, 1>;
  RandomStream random(3, "bias");
  int of_several = 0;
  for (int trial = 0; trial < 10; ++trial) {
    const Model model = tree_of_several(random);
    for (const Joint& joint : model.joints) of_several += joint.rotation[0].several.empty() ? 0 : 1;
    const Mechanism mechanism(model);
    Kinematics<Jet> k(mechanism);
    const Eigen::VectorXd q = test::random_state(model.coordinates.size(), 1.8, random);
    const Eigen::VectorXd qdot = test::random_state(model.coordinates.size(), 3.0, random);
    Eigen::Matrix<Jet, Eigen::Dynamic, 1> qj(q.size()), qdotj = qdot.cast<Jet>();
    for (int i = 0; i < q.size(); ++i) {
      qj(i).a = q(i);
      qj(i).v[0] = qdot(i);  // one second of time, no coordinate acceleration
    }
    update_positions(mechanism, qj.data(), k);
    update_velocities(mechanism, qdotj.data(), k);
    std::vector<SpatialVector<double>> acceleration(at(mechanism.links()));
    for (int i = 1; i < mechanism.links(); ++i) {
      SpatialVector<double>& A = acceleration[i];
      A = acceleration[mechanism.link(i).parent];
      for (int j = 0; j < 3; ++j) {
        A.angular(j) += k.velocity_bias[i].angular(j).a;
        A.linear(j) += k.velocity_bias[i].linear(j).a;
      }
      const Vector3<Jet> point = k.pose[i] * Eigen::Vector3d(0.2, 0.1, -0.3);
      const Vector3<Jet> velocity = k.velocity[i].at(point);
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(velocity(j).a, point(j).v[0], 1e-12);
        EXPECT_NEAR(k.velocity[i].angular(j).v[0], A.angular(j), 1e-11);
        EXPECT_NEAR(k.velocity[i].linear(j).v[0], A.linear(j), 1e-11);
      }
    }
  }
  EXPECT_GT(of_several, 3);
}

TEST(Mechanism, WeldedBodiesBecomeOneLinkOfTheSameMassAndMoment) {
  RandomStream random(4, "weld");
  Model model = test::random_tree(1, random);
  const int second = test::add_body(model, random);
  test::add_weld(model, 1, second, random);
  const Mechanism mechanism(model);
  ASSERT_EQ(mechanism.links(), 2);
  EXPECT_EQ(mechanism.body(second).link, 1);
  const Link& link = mechanism.link(1);
  EXPECT_DOUBLE_EQ(link.mass, model.bodies[1].mass + model.bodies[2].mass);
  // About the link's origin both inertias simply add.
  const auto about_origin = [](double mass, const Eigen::Vector3d& c, const Eigen::Matrix3d& I) -> Eigen::Matrix3d {
    return I + mass * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
  };
  Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (int b = 1; b <= 2; ++b) {
    const Body& body = model.bodies[b];
    const Placement& place = mechanism.body(b).in_link;
    expected +=
        about_origin(body.mass, place * body.mass_center, place.rotation * body.inertia * place.rotation.transpose());
    moment += body.mass * (place * body.mass_center);
  }
  EXPECT_LT((about_origin(link.mass, link.mass_center, link.inertia) - expected).norm(), 1e-13);
  EXPECT_LT((link.mass * link.mass_center - moment).norm(), 1e-13);
}

TEST(Mechanism, ParentsMayComeAfterTheirChildrenInTheFile) {
  Model model = test::pendulum(3);
  std::swap(model.bodies[1], model.bodies[3]);
  for (Joint& j : model.joints) {
    for (int* body : {&j.parent, &j.child}) *body = *body == 1 ? 3 : (*body == 3 ? 1 : *body);
  }
  const Mechanism swapped(model), straight(test::pendulum(3));
  Kinematics<double> a(swapped), b(straight);
  const Eigen::Vector3d q(0.3, -0.4, 0.8);
  update_positions(swapped, q.data(), a);
  update_positions(straight, q.data(), b);
  EXPECT_LT((body_pose(swapped, a, 1).position - body_pose(straight, b, 3).position).norm(), 1e-15);
  for (int i = 1; i < 4; ++i) EXPECT_LT(swapped.link(i).parent, i);
}

std::string refusal_of(const Model& model) {
  try {
    const Mechanism mechanism(model);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Mechanism, NamesWhatIsWrongWithTheTree) {
  using testing::AllOf;
  using testing::HasSubstr;
  Model circle = test::pendulum(3);
  circle.joints[0].parent = 3;
  EXPECT_THAT(refusal_of(circle), AllOf(HasSubstr("rod"), HasSubstr("circle")));

  Model loose = test::pendulum(2);
  loose.bodies.push_back(loose.bodies[1]);
  loose.bodies.back().name = "loose";
  EXPECT_THAT(refusal_of(loose), AllOf(HasSubstr("'loose'"), HasSubstr("no joint")));

  Model twice = test::pendulum(3);
  twice.joints[2].name = "second";
  twice.joints[2].child = 2;
  EXPECT_THAT(refusal_of(twice), AllOf(HasSubstr("'second'"), HasSubstr("'rod2'"), HasSubstr("moved by joint")));

  Model foreign = test::pendulum(2);
  foreign.joints[1].rotation[1].coordinate = 0;
  EXPECT_THAT(refusal_of(foreign), AllOf(HasSubstr("'q0'"), HasSubstr("not its own")));

  Model unused = test::pendulum(1);
  unused.coordinates.push_back(unused.coordinates[0]);
  unused.coordinates.back().name = "orphan";
  EXPECT_THAT(refusal_of(unused), AllOf(HasSubstr("'orphan'"), HasSubstr("no joint")));
}

// Poses and velocities that OpenSim 4.5.2 computed; the leg has spline joints.
class OpenSimBodies : public testing::TestWithParam<const char*> {};

TEST_P(OpenSimBodies, HaveOurPosesAndVelocities) {
  const std::string name = GetParam();
  const std::string file = fmt::format("{}/data/opensim/{}.osim", veridyn::test::shared_folder().string(), name);
  const test::ReferenceTable states = test::read_reference(fmt::format("opensim/g_{}_inverse_dynamics.csv", name));
  const test::ReferenceTable bodies = test::read_reference(fmt::format("opensim/g_{}_bodies.csv", name));
  if (states.rows.empty() || bodies.rows.empty() || !std::filesystem::exists(file)) {
    GTEST_SKIP() << "no " << file << " or its reference";
  }
  const Model model = read_osim(file);
  const Mechanism mechanism(model);
  Kinematics<double> k(mechanism);
  std::size_t compared = 0;
  for (std::size_t row = 0; row < bodies.rows.size(); ++row) {
    const std::string& state = bodies.text(row, "case");
    Eigen::VectorXd q(mechanism.coordinates()), qdot(mechanism.coordinates());
    for (std::size_t s = 0; s < states.rows.size(); ++s) {
      if (states.text(s, "case") != state) continue;
      const int c = model.coordinate(states.text(s, "coordinate"));
      ASSERT_GE(c, 0);
      q(c) = states.number(s, "q_rad_or_m");
      qdot(c) = states.number(s, "qdot");
    }
    update_positions(mechanism, q.data(), k);
    update_velocities(mechanism, qdot.data(), k);
    const int body = model.body(bodies.text(row, "body"));
    ASSERT_GE(body, 0);
    const Pose<double> pose = body_pose(mechanism, k, body);
    const SpatialVector<double>& V = k.velocity[mechanism.body(body).link];
    const Eigen::Vector3d velocity = V.at(pose * model.bodies[body].mass_center);
    const char* const axes[] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i) {
      const std::string axis = axes[i];
      // 15 digits are stored.
      EXPECT_NEAR(pose.position(i), bodies.number(row, axis + "_m"), 1e-13);
      EXPECT_NEAR(velocity(i), bodies.number(row, fmt::format("com_v{}_m_s", axis)), 1e-12);
      EXPECT_NEAR(V.angular(i), bodies.number(row, fmt::format("omega_{}_rad_s", axis)), 1e-12);
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(pose.rotation(i, j), bodies.number(row, fmt::format("R{}{}", i + 1, j + 1)), 1e-13);
      }
    }
    ++compared;
  }
  EXPECT_GE(compared, 40U);
}

INSTANTIATE_TEST_SUITE_P(Models, OpenSimBodies, testing::Values("arm26", "leg6dof9musc"));

}  // namespace
}  // namespace veridyn::muscle
