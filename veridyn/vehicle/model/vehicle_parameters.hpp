#pragma once

#include <array>
#include <string>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/tyre/wheels.hpp"

namespace veridyn::vehicle {

/// The numbers of a two-axle road vehicle, in the symbols of the field; templated so that derivatives with respect to
/// them come from automatic differentiation. SI; axes after ISO 8855 (x forward, y left, z up).
///
/// "One tyre", "one corner": an axle has two. What belongs to an axle ends in f (front) or r (rear).
template <typename Scalar>
struct VehicleParameters {
  Scalar mass{1100.0};         ///< m, the whole vehicle, wheels included [kg]
  Scalar unsprung_mass{40.0};  ///< M_w, what moves with one wheel [kg]
  Scalar a{1.25};              ///< centre of gravity to front axle [m]
  Scalar b{1.00};              ///< centre of gravity to rear axle [m]
  Scalar track_f{1.5};         ///< W, between the wheels' contact points [m]
  Scalar track_r{1.5};
  Scalar cg_height{0.42};  ///< c, above the road at rest [m]
  Scalar I_x{590.0};       ///< roll inertia of the sprung mass about its centre of gravity [kg m^2]
  Scalar I_y{1600.0};      ///< pitch inertia of the same
  Scalar I_z{1100.0};      ///< yaw inertia of the whole vehicle
  Scalar C_f{60000.0};     ///< cornering stiffness of one linear tyre [N/rad]
  Scalar C_r{120000.0};
  Scalar K_sf{20000.0};  ///< suspension spring of one corner, at the wheel [N/m]
  Scalar K_sr{20000.0};
  Scalar C_sf{10000.0};  ///< suspension damper of one corner, at the wheel [N s/m]
  Scalar C_sr{10000.0};
  Scalar K_bf{0.0};  ///< anti-roll bar: force on one wheel per difference of the two wheels' travel [N/m]
  Scalar K_br{0.0};
  Scalar K_tf{20000.0};  ///< vertical stiffness of one tyre [N/m]
  Scalar K_tr{20000.0};
  /// Friction coefficient between linear tyres and road; infinite: no limit.
  Scalar mu{kInfinity};

  [[nodiscard]] Scalar wheelbase() const { return a + b; }

  /// The same numbers in another scalar type, without derivatives.
  template <typename Other>
  [[nodiscard]] VehicleParameters<Other> cast() const;
};

/// A number of `VehicleParameters` as studies and estimates name it.
struct VehicleField {
  const char* name;
  const char* unit;  ///< SI
  const char* meaning;
};
/// All parameters that a study may give.
inline constexpr std::array<VehicleField, 21> kVehicleFields{{
    {"mass", "kg", "whole vehicle"},
    {"unsprung_mass", "kg", "what moves with one wheel"},
    {"a", "m", "centre of gravity to front axle"},
    {"b", "m", "centre of gravity to rear axle"},
    {"track_f", "m", "front track"},
    {"track_r", "m", "rear track"},
    {"cg_height", "m", "centre of gravity above the road"},
    {"I_x", "kg m^2", "roll inertia"},
    {"I_y", "kg m^2", "pitch inertia"},
    {"I_z", "kg m^2", "yaw inertia"},
    {"C_f", "N/rad", "cornering stiffness of one front tyre"},
    {"C_r", "N/rad", "cornering stiffness of one rear tyre"},
    {"K_sf", "N/m", "front suspension spring of one corner"},
    {"K_sr", "N/m", "rear suspension spring of one corner"},
    {"C_sf", "N s/m", "front suspension damper of one corner"},
    {"C_sr", "N s/m", "rear suspension damper of one corner"},
    {"K_bf", "N/m", "front anti-roll bar, at the wheel"},
    {"K_br", "N/m", "rear anti-roll bar, at the wheel"},
    {"K_tf", "N/m", "vertical stiffness of one front tyre"},
    {"K_tr", "N/m", "vertical stiffness of one rear tyre"},
    {"mu", "1", "friction coefficient of linear tyres"},
}};

/// The number that `kVehicleFields[field]` names.
template <typename Scalar>
[[nodiscard]] Scalar& field_of(VehicleParameters<Scalar>& p, std::size_t field) {
  Scalar* const fields[] = {&p.mass, &p.unsprung_mass, &p.a,    &p.b,    &p.track_f, &p.track_r, &p.cg_height,
                            &p.I_x,  &p.I_y,           &p.I_z,  &p.C_f,  &p.C_r,     &p.K_sf,    &p.K_sr,
                            &p.C_sf, &p.C_sr,          &p.K_bf, &p.K_br, &p.K_tf,    &p.K_tr,    &p.mu};
  static_assert(std::size(fields) == kVehicleFields.size());
  return *fields[field];
}
/// A parameter by its place in `kVehicleFields`.
template <typename Scalar>
[[nodiscard]] const Scalar& field_of(const VehicleParameters<Scalar>& p, std::size_t field) {
  return field_of(const_cast<VehicleParameters<Scalar>&>(p), field);
}

template <typename Scalar>
template <typename Other>
VehicleParameters<Other> VehicleParameters<Scalar>::cast() const {
  VehicleParameters<Other> to;
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) field_of(to, i) = Other(field_of(*this, i));
  return to;
}

/// Why no vehicle can have these numbers, naming the parameter, its value and its rule ("track_f is 0; must be > 0");
/// empty when all is well. Masses, distances, inertias and stiffnesses are positive (dampers, anti-roll bars and the
/// height of the centre of gravity may be 0) and the wheels together are lighter than the vehicle.
[[nodiscard]] std::string inadmissible(const VehicleParameters<double>& parameters);

/// Static load of one tyre [N] on level ground: m g b/(2 L) in front, m g a/(2 L) behind.
template <typename Scalar>
[[nodiscard]] PerWheel<Scalar> static_loads(const VehicleParameters<Scalar>& p, double gravity) {
  const Scalar front = p.mass * gravity * p.b / (2.0 * p.wheelbase());
  const Scalar rear = p.mass * gravity * p.a / (2.0 * p.wheelbase());
  return {front, front, rear, rear};
}

}  // namespace veridyn::vehicle
