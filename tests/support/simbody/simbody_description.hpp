#pragma once

#include "tests/support/simbody/simbody_tree.hpp"
#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle::test {

/// The mobilizer of the joint's own type, as OpenSim takes it.
[[nodiscard]] inline TreeDescription::Mobilizer mobilizer_of(const Joint& joint) {
  using Mobilizer = TreeDescription::Mobilizer;
  if (joint.type == "UniversalJoint") return Mobilizer::kUniversal;
  if (joint.type == "BallJoint") return Mobilizer::kBall;
  if (joint.type == "GimbalJoint") return Mobilizer::kGimbal;
  if (joint.type == "PlanarJoint") return Mobilizer::kPlanar;
  if (joint.type == "FreeJoint") return Mobilizer::kFree;
  if (joint.is_ellipsoid()) return Mobilizer::kEllipsoid;
  return Mobilizer::kFunctions;
}

[[nodiscard]] inline TreeDescription describe(const Model& model) {
  TreeDescription tree;
  tree.gravity = model.gravity;
  tree.coordinates = model.coordinates.size();
  for (const Body& b : model.bodies) tree.bodies.push_back({b.mass, b.mass_center, b.inertia});
  for (const Joint& j : model.joints) {
    TreeDescription::Joint joint{j.parent,
                                 j.child,
                                 {j.parent_frame.rotation, j.parent_frame.translation},
                                 {j.child_frame.rotation, j.child_frame.translation},
                                 j.coordinates,
                                 {}};
    joint.reversed = j.reversed;
    joint.radii = j.ellipsoid_radii;
    joint.mobilizer = mobilizer_of(j);
    for (std::size_t i = 0; i < 6; ++i) {
      const TransformAxis& axis = i < 3 ? j.rotation[i] : j.translation[i - 3];
      joint.axes[i] = {axis.axis, axis.coordinate, [f = axis.function](double x) {
                         const numerics::FunctionValue<double> v = f.evaluate(x);
                         return std::array<double, 3>{v.value, v.slope, v.curvature};
                       }};
      joint.axes[i].several = axis.several;
      joint.axes[i].of_several = [f = axis.function_of_several](const std::vector<int>& by,
                                                                const std::vector<double>& x) {
        std::vector<double> gradient(x.size()), hessian(x.size() * x.size());
        const double value = f.evaluate(x.data(), gradient.data(), hessian.data());
        if (by.empty()) return value;
        const auto first = static_cast<std::size_t>(by[0]);
        return by.size() == 1 ? gradient[first] : hessian[first * x.size() + static_cast<std::size_t>(by[1])];
      };
    }
    tree.joints.push_back(std::move(joint));
  }
  for (const LoopConstraint& c : model.loops) {
    using Kind = TreeDescription::Constraint::Kind;
    Kind kind = Kind::kPoint;
    if (c.kind == LoopKind::kWeld) kind = Kind::kWeld;
    if (c.kind == LoopKind::kDistance) kind = Kind::kDistance;
    if (c.kind == LoopKind::kPointOnLine) kind = Kind::kPointOnLine;
    tree.constraints.push_back({kind,
                                c.body_1,
                                c.body_2,
                                {c.frame_1.rotation, c.frame_1.translation},
                                {c.frame_2.rotation, c.frame_2.translation},
                                c.distance});
  }
  return tree;
}

}  // namespace veridyn::muscle::test
