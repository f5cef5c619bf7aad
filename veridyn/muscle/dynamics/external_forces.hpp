#pragma once

#include "veridyn/muscle/dynamics/body_forces.hpp"
#include "veridyn/muscle/model/external_load.hpp"

/// Forces of the surroundings on bodies, at the poses of a motion. Nothing allocates or throws.
namespace veridyn::muscle {

/// Force and moment about the ground's origin of a load at a time, in ground. Kinematics need `update_positions`.
template <typename Scalar>
SpatialVector<Scalar> external_wrench(const ExternalLoad& load, double time, const Mechanism& mechanism,
                                      const Kinematics<Scalar>& kinematics) {
  const auto at_time = [&](const std::array<numerics::PiecewisePolynomial, 3>& f) {
    return Eigen::Vector3d(f[0].evaluate(time).value, f[1].evaluate(time).value, f[2].evaluate(time).value);
  };
  const Pose<Scalar> axes = body_pose(mechanism, kinematics, load.force_frame);
  const Vector3<Scalar> force = internal::rotate(axes.rotation, at_time(load.force));
  const Vector3<Scalar> point = body_pose(mechanism, kinematics, load.point_frame) * at_time(load.point);
  return {internal::rotate(axes.rotation, at_time(load.moment)) + point.cross(force), force};
}

/// Adds all loads of a time to generalised forces by coordinate or to forces by link, see `add_force_at`.
template <typename Scalar, typename Receiver>
void add_external_forces(const ExternalLoads& loads, double time, const Mechanism& mechanism,
                         const Kinematics<Scalar>& kinematics, Receiver* to) {
  for (const ExternalLoad& load : loads.loads)
    add_wrench(mechanism, kinematics, mechanism.body(load.body).link,
               external_wrench(load, time, mechanism, kinematics), to);
}

}  // namespace veridyn::muscle
