#pragma once

#include "tests/support/simbody/simbody_tree.hpp"
#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle::test {

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
    for (std::size_t i = 0; i < 6; ++i) {
      const TransformAxis& axis = i < 3 ? j.rotation[i] : j.translation[i - 3];
      joint.axes[i] = {axis.axis, axis.coordinate, [f = axis.function](double x) {
                         const numerics::FunctionValue<double> v = f.evaluate(x);
                         return std::array<double, 3>{v.value, v.slope, v.curvature};
                       }};
    }
    tree.joints.push_back(std::move(joint));
  }
  return tree;
}

}  // namespace veridyn::muscle::test
