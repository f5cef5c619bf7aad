#pragma once

#include <Eigen/Core>

#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle {

/// Result of OpenSim 4.5's wrap objects for one straight segment (`WrapObject::wrapLine`), values as its enumeration.
enum class OpenSimWrapAction {
  kNone,       ///< the segment stays straight
  kInside,     ///< an end lies inside the object: straight
  kWrapped,    ///< wraps, but another segment of the path may do so with a smaller change of length
  kMandatory,  ///< the segment meets the object: this one wraps
};

/// One segment as OpenSim wraps it.
struct OpenSimWrap {
  OpenSimWrapAction action = OpenSimWrapAction::kNone;
  Eigen::Vector3d r1 = Eigen::Vector3d::Zero();  ///< where the path reaches the object
  Eigen::Vector3d r2 = Eigen::Vector3d::Zero();  ///< where it leaves it
  double surface_length = 0.0;                   ///< [m]

  [[nodiscard]] bool wraps() const {
    return action == OpenSimWrapAction::kWrapped || action == OpenSimWrapAction::kMandatory;
  }
};

/// OpenSim 4.5's wrap of the segment from `p` to `q` (object frame, [m]), its approximations included, so that a
/// user can see what in a comparison is OpenSim's and what is ours: the ellipsoid's plane from closest points (hybrid,
/// midpoint, axial; a fan of 298 samples), lengths of polygons with sides of 1 mm, the cylinder's tangent points that
/// are shifted along the axis by an empirical rule. `only_wrap_of_path` selects the shorter rule that OpenSim uses for
/// the cylinder of a path with a single wrap. After opensim-core 4.5 (WrapCylinder, WrapEllipsoid, WrapSphere,
/// WrapTorus), implemented independently. No memory of earlier poses.
///
/// Not for simulation: lengths jump, and moment arms are not their derivatives (docs/muscle).
[[nodiscard]] OpenSimWrap wrap_as_opensim(const WrapObject& object, EllipsoidMethod method, bool only_wrap_of_path,
                                          const Eigen::Vector3d& p, const Eigen::Vector3d& q);

}  // namespace veridyn::muscle
