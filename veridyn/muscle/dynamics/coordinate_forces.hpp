#pragma once

#include <cstddef>
#include <span>
#include <variant>

#include "veridyn/muscle/model/model.hpp"

/// Generalised forces that act on single coordinates: actuators, springs, and the springs and dampers of their limits;
/// and the tension of passive paths. Nothing allocates or throws.
namespace veridyn::muscle {

namespace internal {

/// The quintic step 10 x^3 - 15 x^4 + 6 x^5 from 0 at x <= 0 to 1 at x >= 1, with two continuous derivatives.
template <typename Scalar>
[[nodiscard]] Scalar smooth_step(const Scalar& x) {
  if (!(x > 0.0)) return x * 0.0;
  if (x >= 1.0) return x * 0.0 + 1.0;
  return x * x * x * (x * (x * 6.0 - 15.0) + 10.0);
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

/// Adds the forces of the limits to tau (by coordinate).
template <typename Scalar>
void add_limit_forces(std::span<const CoordinateLimitForce> limits, const Scalar* q, const Scalar* qdot, Scalar* tau) {
  for (const CoordinateLimitForce& limit : limits) {
    tau[limit.coordinate] += limit_force(limit, q[limit.coordinate], qdot[limit.coordinate]);
  }
}

/// Force of a spring and damper on a coordinate [N m or N].
template <typename Scalar>
[[nodiscard]] Scalar spring_force(const CoordinateSpring& spring, const Scalar& q, const Scalar& qdot) {
  return (q - spring.rest_length) * (-spring.stiffness) - qdot * spring.viscosity;
}

/// Adds the forces of a model's limits and of its springs on single coordinates to tau (by coordinate).
template <typename Scalar>
void add_coordinate_forces(const Model& model, const Scalar* q, const Scalar* qdot, Scalar* tau) {
  add_limit_forces<Scalar>(model.limit_forces, q, qdot, tau);
  for (const CoordinateSpring& spring : model.coordinate_springs)
    tau[spring.coordinate] += spring_force(spring, q[spring.coordinate], qdot[spring.coordinate]);
}

/// Tension by the law of Blankevoort & Huiskes: the spring's part and the damper's [N].
template <typename Scalar>
[[nodiscard]] Scalar blankevoort_tension(const BlankevoortLaw& law, const Scalar& length, const Scalar& speed) {
  const Scalar strain = length / law.slack_length - 1.0;
  if (!(strain > Scalar(0.0))) return length * 0.0;
  Scalar tension = strain < Scalar(law.transition_strain)
                       ? Scalar(strain * strain * (0.5 * law.linear_stiffness / law.transition_strain))
                       : Scalar((strain - 0.5 * law.transition_strain) * law.linear_stiffness);
  constexpr double kFullDamping = 0.01;
  if (speed > Scalar(0.0))
    tension +=
        speed * (law.damping_coefficient / law.slack_length) * internal::smooth_step(Scalar(strain / kFullDamping));
  return tension;
}

/// Tension of a stretched path of this length and lengthening speed; 0 while it is slack [N].
template <typename Scalar>
[[nodiscard]] Scalar passive_tension(const PassivePathLaw& law, const Scalar& length, const Scalar& speed) {
  Scalar tension = length * 0.0;
  if (const auto* spring = std::get_if<PathSpringLaw>(&law)) {
    if (length > Scalar(spring->resting_length))
      tension = (length - spring->resting_length) * spring->stiffness * (speed * spring->dissipation + 1.0);
  } else if (const auto* ligament = std::get_if<LigamentLaw>(&law)) {
    if (length > Scalar(ligament->resting_length))
      tension = ligament->curve.evaluate(Scalar((length - ligament->resting_length) / ligament->resting_length)).value *
                ligament->pcsa_force;
  } else if (const auto* blankevoort = std::get_if<BlankevoortLaw>(&law)) {
    tension = blankevoort_tension(*blankevoort, length, speed);
  }
  return tension > Scalar(0.0) ? tension : length * 0.0;
}

}  // namespace veridyn::muscle
