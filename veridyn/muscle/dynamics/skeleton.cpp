#include "veridyn/muscle/dynamics/skeleton.hpp"

namespace veridyn::muscle {

std::vector<Polyline> bones(const Model& model, const Mechanism& mechanism, const Kinematics<double>& kinematics) {
  std::vector<Polyline> lines;
  for (std::size_t b = 1; b < model.bodies.size(); ++b) {
    const Pose<double> pose = body_pose(mechanism, kinematics, static_cast<int>(b));
    Eigen::Vector3d joint = pose.position;
    bool carries = false;
    for (const Joint& j : model.joints) {
      if (j.child == static_cast<int>(b)) joint = pose * j.child_frame.translation;
    }
    for (const Joint& j : model.joints) {
      if (j.parent != static_cast<int>(b)) continue;
      const Body& child = model.bodies[j.child];
      // What is welded on, such as a load, makes no stick.
      if (j.coordinates.empty() && child.mass_center.isZero(0.0)) continue;
      carries = true;
      // Where the child is, which a joint that translates, such as a knee, moves away from its frame in the parent.
      const Eigen::Vector3d carried = body_pose(mechanism, kinematics, j.child) * j.child_frame.translation;
      lines.push_back({model.bodies[b].name, {joint, carried}});
    }
    if (!carries && model.bodies[b].mass > 0.0) {
      const Eigen::Vector3d center = pose * model.bodies[b].mass_center;
      lines.push_back({model.bodies[b].name, {joint, joint + 2.0 * (center - joint)}});
    }
  }
  return lines;
}

}  // namespace veridyn::muscle
