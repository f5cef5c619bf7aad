#pragma once

#include <concepts>
#include <string_view>

namespace veridyn::vehicle {

/// What the road does to one tyre, along the axes of the wheel projected onto the road: x where the wheel points, y to
/// its left (ISO 8855 tyre axes) [N].
template <typename Scalar>
struct TyreForces {
  Scalar Fx{0.0};
  Scalar Fy{0.0};
};

/// A tyre model, for one scalar type. Every tyre of this project takes
///
/// - `load`: normal force [N], >= 0; at 0 all forces are 0;
/// - `slip_ratio`: kappa = (R omega - V_x)/|V_x|, positive when driving;
/// - `slip_angle`: alpha = -atan(V_y/|V_x|) of the contact point in the wheel's axes [rad], so that a positive slip
///   angle gives a positive (leftward) force: alpha = delta - atan((v + a r)/u) of a front wheel. Tyre files measure it
///   the other way round; their readers convert;
/// - `camber`: inclination of the wheel as a rotation about its x axis: positive leans the top to the right [rad].
///
/// `cornering_stiffness(load)` is dFy/d slip_angle at zero slip [N/rad], positive.
template <typename Tyre, typename Scalar>
concept TyreModel = requires(const Tyre& tyre, const Scalar& number) {
  { tyre.forces(number, number, number, number) } -> std::same_as<TyreForces<Scalar>>;
  { tyre.cornering_stiffness(number) } -> std::convertible_to<Scalar>;
};

/// A number of a tyre law's own that a study may give in `[subject.tyres]`, without a unit.
template <typename Tyre>
struct TyreKey {
  std::string_view name;
  double Tyre::*value;
  std::string_view meaning = "";            ///< written behind it; may be empty
  bool (*is_admissible)(double) = nullptr;  ///< null: any number is
  std::string_view otherwise = "";          ///< what is said of an inadmissible one, a format of the value
};

}  // namespace veridyn::vehicle
