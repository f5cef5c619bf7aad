#pragma once

#include <cstddef>
#include <span>

#include "veridyn/muscle/model/model.hpp"

/// Generalised forces that act on single coordinates: actuators, and the springs and dampers of their limits. Nothing
/// allocates or throws.
namespace veridyn::muscle {

namespace internal {

/// The quintic step 10 x^3 - 15 x^4 + 6 x^5 from 0 at x <= 0 to 1 at x >= 1, with two continuous derivatives.
template <typename Scalar>
[[nodiscard]] Scalar smooth_step(const Scalar& x) {
  if (!(x > 0.0)) return x * 0.0;
  if (x >= 1.0) return x * 0.0 + 1.0;
  return x * x * x * (x * (x * 6.0 - 15.0) + 10.0);
}

/// Integral of x smooth_step(x) from 0 to x.
template <typename Scalar>
[[nodiscard]] Scalar smooth_step_moment(const Scalar& x) {
  if (!(x > 0.0)) return x * 0.0;
  if (x >= 1.0) return 0.5 * x * x - 1.0 / 7.0;
  const Scalar x2 = x * x;
  return x2 * x2 * x * (x * (x * (6.0 / 7.0) - 2.5) + 2.0);
}

}  // namespace internal

/// Force of a coordinate limit [N m or N] at value q and speed qdot, as OpenSim 4.5 has it (CoordinateLimitForce):
///
///     tau = -K+ s+ (q - upper) + K- s- (lower - q) - damping (s+ + s-) qdot
///
/// where s+ rises from 0 at the upper limit to 1 at upper + transition by the quintic step, and s- the other way below
/// the lower limit. `limit.transition` must be > 0. Stiffness, damping and transition are per radian or metre here; in
/// the files they are per degree for rotational coordinates.
template <typename Scalar>
[[nodiscard]] Scalar limit_force(const CoordinateLimitForce& limit, const Scalar& q, const Scalar& qdot) {
  const Scalar above = q - limit.upper_limit, below = limit.lower_limit - q;
  const Scalar up = internal::smooth_step(Scalar(above / limit.transition));
  const Scalar low = internal::smooth_step(Scalar(below / limit.transition));
  return limit.lower_stiffness * low * below - limit.upper_stiffness * up * above - limit.damping * (up + low) * qdot;
}

/// Energy stored in the limit's springs [J]: minus its derivative is the force at rest.
template <typename Scalar>
[[nodiscard]] Scalar limit_energy(const CoordinateLimitForce& limit, const Scalar& q) {
  const double unit = limit.transition * limit.transition;
  return limit.upper_stiffness * unit *
             internal::smooth_step_moment(Scalar((q - limit.upper_limit) / limit.transition)) +
         limit.lower_stiffness * unit *
             internal::smooth_step_moment(Scalar((limit.lower_limit - q) / limit.transition));
}

/// Adds the forces of the limits to tau (by coordinate).
template <typename Scalar>
void add_limit_forces(std::span<const CoordinateLimitForce> limits, const Scalar* q, const Scalar* qdot, Scalar* tau) {
  for (const CoordinateLimitForce& limit : limits) {
    tau[limit.coordinate] += limit_force(limit, q[limit.coordinate], qdot[limit.coordinate]);
  }
}

/// Adds optimal_force * control of each actuator to tau. Controls are taken as they are: OpenSim too keeps the bounds
/// for its optimisers and does not clamp.
template <typename Scalar>
void add_actuator_forces(std::span<const CoordinateActuator> actuators, const Scalar* controls, Scalar* tau) {
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    tau[actuators[i].coordinate] += actuators[i].optimal_force * controls[i];
  }
}

}  // namespace veridyn::muscle
