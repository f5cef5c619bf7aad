#include "tests/muscle/dynamics/loop_models.hpp"

#include <fmt/format.h>

#include "veridyn/muscle/dynamics/mechanism.hpp"

namespace veridyn::muscle::test {

Model four_bar() {
  Model model = pendulum(2);
  model.name = "four bar";
  constexpr double kCrank = 0.3, kCoupler = 0.5, kRocker = 0.4, kBase = 0.6;
  model.bodies[1].name = "crank";
  model.bodies[1].mass_center = {0.0, -0.5 * kCrank, 0.0};
  model.bodies[2].name = "coupler";
  model.bodies[2].mass_center = {0.0, -0.5 * kCoupler, 0.0};
  model.joints[1].parent_frame.translation = {0.0, -kCrank, 0.0};
  Body rocker = model.bodies[1];
  rocker.name = "rocker";
  rocker.mass_center = {0.0, -0.5 * kRocker, 0.0};
  model.bodies.push_back(rocker);
  Joint joint = model.joints[0];
  joint.name = "rocker_pin";
  joint.child = 3;
  joint.parent_frame.translation = {kBase, 0.0, 0.0};
  joint.coordinates = {2};
  joint.rotation[0].coordinate = 2;
  Coordinate q = model.coordinates[0];
  q.name = "q2";
  q.joint = 2;
  model.coordinates.push_back(q);
  model.joints.push_back(joint);
  for (Joint& each : model.joints) each.rotation[2].axis = Eigen::Vector3d::UnitX();  // Simbody wants no parallel axes
  for (Coordinate& c : model.coordinates) {
    c.low = -10.0;
    c.high = 10.0;
  }
  model.loops.push_back({.name = "hinge",
                         .kind = LoopKind::kPoint,
                         .body_1 = 3,
                         .body_2 = 2,
                         .frame_1 = {.translation = {0.0, -kRocker, 0.0}},
                         .frame_2 = {.translation = {0.0, -kCoupler, 0.0}}});
  return model;
}

Model random_loops(numerics::RandomStream& random) {
  Model model;
  model.name = "random loops";
  model.gravity = random_vector(9.0, random);
  model.bodies.resize(1);
  model.bodies[0].name = "ground";
  for (int i = 0; i < 5; ++i) {
    const int parent = i == 0 ? 0 : static_cast<int>(random.index(model.bodies.size()));
    const int child = add_body(model, random);
    constexpr TreeJoint kKinds[] = {TreeJoint::kFree, TreeJoint::kFree, TreeJoint::kGimbal, TreeJoint::kFree,
                                    TreeJoint::kPin};
    add_joint(model, kKinds[i], parent, child, random);
  }
  const Eigen::VectorXd q = random_state(model.coordinates.size(), 1.0, random);
  const Mechanism mechanism(model);
  Kinematics<double> kinematics(mechanism);
  update_positions(mechanism, q.data(), kinematics);
  const auto place = [&](int body) {
    const Pose<double> pose = body_pose(mechanism, kinematics, body);
    return Placement{pose.rotation, pose.position};
  };
  for (const LoopKind kind : {LoopKind::kPoint, LoopKind::kWeld, LoopKind::kDistance, LoopKind::kPointOnLine}) {
    LoopConstraint c;
    c.name = fmt::format("loop{}", model.loops.size());
    c.kind = kind;
    c.body_1 = static_cast<int>(random.index(model.bodies.size()));
    do {
      c.body_2 = static_cast<int>(random.index(model.bodies.size()));
    } while (c.body_2 == c.body_1);
    c.frame_1 = random_placement(random);
    // Where frame 1 is, or at a distance from it, or along the line.
    c.frame_2 = place(c.body_2).inverse() * place(c.body_1) * c.frame_1;
    const Eigen::Vector3d away = random_vector(0.4, random);
    c.distance = away.norm();
    if (kind == LoopKind::kDistance) c.frame_2 = c.frame_2 * Placement{.translation = away};
    if (kind == LoopKind::kPointOnLine) c.frame_2 = c.frame_2 * Placement{.translation = {away.x(), 0.0, 0.0}};
    model.loops.push_back(c);
  }
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    model.coordinates[c].default_value = q(c);
    model.coordinates[c].low = -100.0;
    model.coordinates[c].high = 100.0;
  }
  return model;
}

}  // namespace veridyn::muscle::test
