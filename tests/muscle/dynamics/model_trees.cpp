#include "tests/muscle/dynamics/model_trees.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace veridyn::muscle::test {
namespace {

int new_coordinate(Model& model, Joint& joint, CoordinateMotion motion) {
  Coordinate c;
  c.name = fmt::format("q{}", model.coordinates.size());
  c.motion = motion;
  c.joint = static_cast<int>(model.joints.size());
  model.coordinates.push_back(c);
  const int index = static_cast<int>(model.coordinates.size()) - 1;
  joint.coordinates.push_back(index);
  return index;
}

void set_axis(TransformAxis& axis, const Eigen::Vector3d& direction, int coordinate,
              numerics::PiecewisePolynomial function) {
  axis.axis = direction.normalized();
  axis.coordinate = coordinate;
  axis.function = std::move(function);
}

Joint blank_joint(const Model& model, int parent, int child) {
  Joint joint;
  joint.name = fmt::format("joint{}", model.joints.size());
  joint.type = "CustomJoint";
  joint.parent = parent;
  joint.child = child;
  for (int i = 0; i < 3; ++i) {
    joint.rotation[i].axis = Eigen::Vector3d::Unit(i);
    joint.translation[i].axis = Eigen::Vector3d::Unit(i);
  }
  return joint;
}

numerics::PiecewisePolynomial random_spline(double size, numerics::RandomStream& random) {
  const std::array<double, 7> x{-2.0, -1.2, -0.5, 0.1, 0.7, 1.3, 2.0};
  std::array<double, 7> y{};
  for (double& value : y) value = random.uniform(-size, size);
  return numerics::PiecewisePolynomial::simm_spline(x, y);
}

/// The axis moves by `slope` times the first of these coordinates and a small polynomial in all of them.
void set_axis_of_several(TransformAxis& axis, const Eigen::Vector3d& direction, std::vector<int> coordinates, int order,
                         double slope, numerics::RandomStream& random) {
  using numerics::MultivariatePolynomial;
  const int n = static_cast<int>(coordinates.size());
  std::vector<double> c(MultivariatePolynomial::terms(n, order));
  for (double& x : c) x = random.uniform(-0.06, 0.06);
  const std::vector<MultivariatePolynomial::Powers> powers = MultivariatePolynomial::powers(n, order);
  for (std::size_t t = 0; t < powers.size(); ++t)
    if (std::accumulate(powers[t].begin(), powers[t].end(), 0) == 1 && powers[t][0] == 1) c[t] += slope;
  axis.axis = direction.normalized();
  axis.several = std::move(coordinates);
  axis.function_of_several = {n, order, c};
}

}  // namespace

Eigen::Vector3d random_vector(double size, numerics::RandomStream& random) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v(i) = random.uniform(-size, size);
  return v;
}

Placement random_placement(numerics::RandomStream& random) {
  return {body_fixed_xyz(random_vector(1.5, random)), random_vector(0.3, random)};
}

Model arm26_skeleton() {
  Model m;
  m.name = "arm26";
  m.gravity = {0.0, -9.8066, 0.0};
  m.bodies.resize(4);
  m.bodies[0].name = "ground";
  m.bodies[1].name = "base";
  m.bodies[2].name = "r_humerus";
  m.bodies[2].mass = 1.864572;
  m.bodies[2].mass_center = {0.0, -0.180496, 0.0};
  m.bodies[2].inertia.diagonal() << 0.01481, 0.004551, 0.013193;
  m.bodies[3].name = "r_ulna_radius_hand";
  m.bodies[3].mass = 1.534315;
  m.bodies[3].mass_center = {0.0, -0.181479, 0.0};
  m.bodies[3].inertia.diagonal() << 0.019281, 0.001571, 0.020062;

  Joint offset = blank_joint(m, 0, 1);
  offset.name = "offset";
  offset.parent_frame.translation = {0.0, 0.8, 0.0};
  m.joints.push_back(offset);
  const auto add = [&m](const char* joint_name, const char* coordinate_name, int parent, int child,
                        const Eigen::Vector3d& location, const Eigen::Vector3d& axis, double low, double high) {
    Joint joint = blank_joint(m, parent, child);
    joint.name = joint_name;
    joint.parent_frame.translation = location;
    const int c = new_coordinate(m, joint, CoordinateMotion::kRotational);
    Coordinate& coordinate = m.coordinates.back();
    coordinate.name = coordinate_name;
    coordinate.low = low;
    coordinate.high = high;
    set_axis(joint.rotation[0], axis, c, numerics::PiecewisePolynomial::linear(1.0, 0.0));
    set_axis(joint.rotation[2], {axis.z(), 0.0, -axis.x()}, -1, numerics::PiecewisePolynomial::constant(0.0));
    m.joints.push_back(joint);
  };
  add("r_shoulder", "r_shoulder_elev", 1, 2, {-0.017545, -0.007, 0.17}, {-0.05889802, 0.0023, 0.99826136}, -1.57079633,
      3.14159265);
  add("r_elbow", "r_elbow_flex", 2, 3, {0.0061, -0.2904, -0.0123}, {0.04940001, 0.03660001, 0.99810825}, 0.0,
      2.26892803);
  return m;
}

int add_body(Model& model, numerics::RandomStream& random) {
  Body body;
  body.name = fmt::format("body{}", model.bodies.size());
  body.mass = random.uniform(0.3, 8.0);
  body.mass_center = random_vector(0.2, random);
  // The inertia of four points, so that it is one that a body can have.
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d r = random_vector(0.15, random);
    body.inertia += 0.25 * body.mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  model.bodies.push_back(body);
  return static_cast<int>(model.bodies.size()) - 1;
}

Joint& add_joint(Model& model, TreeJoint kind, int parent, int child, numerics::RandomStream& random) {
  Joint joint = blank_joint(model, parent, child);
  joint.parent_frame = random_placement(random);
  joint.child_frame = random_placement(random);
  const auto linear = [&random]() {
    return numerics::PiecewisePolynomial::linear(random.uniform() < 0.5 ? 1.0 : random.uniform(0.5, 1.5),
                                                 random.uniform() < 0.5 ? 0.0 : random.uniform(-0.2, 0.2));
  };
  const auto rotation = [&](int i, const Eigen::Vector3d& axis) {
    const int c = new_coordinate(model, joint, CoordinateMotion::kRotational);
    set_axis(joint.rotation[i], axis, c, linear());
  };
  const auto translation = [&](int i, const Eigen::Vector3d& axis) {
    const int c = new_coordinate(model, joint, CoordinateMotion::kTranslational);
    set_axis(joint.translation[i], axis, c, linear());
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  switch (kind) {
    case TreeJoint::kPin:
      rotation(0, z + random_vector(0.4, random));
      joint.rotation[2].axis = x;  // Simbody wants no two axes to be parallel, even without motion
      break;
    case TreeJoint::kSlider:
      translation(0, x + random_vector(0.4, random));
      break;
    case TreeJoint::kUniversal:
      rotation(0, x);
      rotation(1, y);
      break;
    case TreeJoint::kPlanar:
      // Coordinates in another order than the axes.
      rotation(0, z);
      joint.rotation[2].axis = x;
      translation(0, x);
      translation(1, y);
      break;
    case TreeJoint::kSpline: {
      const int c = new_coordinate(model, joint, CoordinateMotion::kRotational);
      set_axis(joint.rotation[0], z + random_vector(0.2, random), c, numerics::PiecewisePolynomial::linear(1.0, 0.0));
      set_axis(joint.rotation[1], x + random_vector(0.2, random), c, random_spline(0.3, random));
      joint.rotation[2].function = numerics::PiecewisePolynomial::constant(random.uniform(-0.5, 0.5));
      joint.rotation[2].axis = y;
      set_axis(joint.translation[0], x, c, random_spline(0.05, random));
      set_axis(joint.translation[1], y, c, random_spline(0.05, random));
      break;
    }
    case TreeJoint::kFree:
      for (int i = 0; i < 3; ++i) rotation(i, Eigen::Vector3d::Unit(i));
      for (int i = 0; i < 3; ++i) translation(i, Eigen::Vector3d::Unit(i));
      break;
    case TreeJoint::kGimbal:
      rotation(0, z + random_vector(0.3, random));
      rotation(1, x + random_vector(0.3, random));
      rotation(2, y + random_vector(0.3, random));
      joint.translation[2].function = numerics::PiecewisePolynomial::constant(random.uniform(-0.2, 0.2));
      break;
    case TreeJoint::kSeveral: {
      const int a = new_coordinate(model, joint, CoordinateMotion::kRotational);
      const int b = new_coordinate(model, joint, CoordinateMotion::kRotational);
      const int c = new_coordinate(model, joint, CoordinateMotion::kRotational);
      set_axis(joint.rotation[0], z + random_vector(0.2, random), a, linear());
      set_axis_of_several(joint.rotation[1], x + random_vector(0.2, random), {b, a}, 2, 1.0, random);
      set_axis_of_several(joint.rotation[2], y + random_vector(0.2, random), {c, b}, 3, 1.0, random);
      set_axis_of_several(joint.translation[0], x, {c, b, a}, 3, 0.2, random);
      set_axis(joint.translation[1], y, a, random_spline(0.05, random));
      set_axis_of_several(joint.translation[2], z, {a, c}, 1, 0.1, random);
      break;
    }
  }
  model.joints.push_back(joint);
  return model.joints.back();
}

Joint& add_weld(Model& model, int parent, int child, numerics::RandomStream& random) {
  Joint joint = blank_joint(model, parent, child);
  joint.parent_frame = random_placement(random);
  joint.child_frame = random_placement(random);
  for (std::size_t i = 0; i < 3; ++i) {
    joint.rotation[i].function = numerics::PiecewisePolynomial::constant(random.uniform(-1.0, 1.0));
    joint.translation[i].function = numerics::PiecewisePolynomial::constant(random.uniform(-0.1, 0.1));
  }
  model.joints.push_back(joint);
  return model.joints.back();
}

Model random_tree(int bodies, numerics::RandomStream& random) {
  Model model;
  model.name = "random tree";
  model.gravity = random_vector(9.0, random);
  model.bodies.resize(1);
  model.bodies[0].name = "ground";
  for (int i = 0; i < bodies; ++i) {
    const int parent = static_cast<int>(random.index(model.bodies.size()));
    const int child = add_body(model, random);
    if (i > 0 && random.index(8) == 0) {
      add_weld(model, parent, child, random);
    } else {
      add_joint(model, static_cast<TreeJoint>(random.index(kTreeJoints)), parent, child, random);
    }
  }
  return model;
}

Model pendulum(int rods) {
  Model model;
  model.name = "pendulum";
  model.bodies.resize(1);
  model.bodies[0].name = "ground";
  for (int i = 0; i < rods; ++i) {
    Body rod;
    rod.name = fmt::format("rod{}", i + 1);
    rod.mass = 1.0 + 0.5 * i;
    rod.mass_center = {0.0, -0.25, 0.0};
    rod.inertia.diagonal() << 0.02, 0.001, 0.02;
    model.bodies.push_back(rod);
    Joint joint = blank_joint(model, i, i + 1);
    if (i > 0) joint.parent_frame.translation = {0.0, -0.5, 0.0};
    const int c = new_coordinate(model, joint, CoordinateMotion::kRotational);
    set_axis(joint.rotation[0], Eigen::Vector3d::UnitZ(), c, numerics::PiecewisePolynomial::linear(1.0, 0.0));
    model.joints.push_back(joint);
  }
  return model;
}

Model gait_like() {
  numerics::RandomStream random(2392, "gait");
  Model model;
  model.name = "gait";
  model.bodies.resize(1);
  model.bodies[0].name = "ground";
  const int pelvis = add_body(model, random);
  add_joint(model, TreeJoint::kFree, 0, pelvis, random);
  for (int leg = 0; leg < 2; ++leg) {
    const int femur = add_body(model, random);
    add_joint(model, TreeJoint::kGimbal, pelvis, femur, random);
    const int tibia = add_body(model, random);
    add_joint(model, TreeJoint::kSpline, femur, tibia, random);
    int last = tibia;
    for (int i = 0; i < 3; ++i) {
      const int next = add_body(model, random);
      add_joint(model, TreeJoint::kPin, last, next, random);
      last = next;
    }
  }
  const int torso = add_body(model, random);
  add_joint(model, TreeJoint::kGimbal, pelvis, torso, random);
  return model;
}

Eigen::VectorXd random_state(std::size_t size, double magnitude, numerics::RandomStream& random) {
  Eigen::VectorXd v(size);
  for (double& x : v) x = random.uniform(-magnitude, magnitude);
  return v;
}

}  // namespace veridyn::muscle::test
