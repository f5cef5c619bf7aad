#pragma once

#include "veridyn/vehicle/model/four_wheel_models.hpp"

namespace veridyn::vehicle::testing {

template <typename Scalar>
using LinearCar = FourWheelModel<Scalar, LinearTyre<Scalar>>;

/// The four-wheel model on linear tyres of the parameters' stiffness and friction.
template <typename Scalar>
LinearCar<Scalar> linear_car(const VehicleParameters<Scalar>& p, const FourWheelOptions& options = {}) {
  const LinearTyre<Scalar> front{.stiffness = p.C_f, .mu = p.mu}, rear{.stiffness = p.C_r, .mu = p.mu};
  return {p, {front, front, rear, rear}, options};
}

/// The same on tyres with a pneumatic trail.
template <typename Scalar>
LinearCar<Scalar> trailing_car(const VehicleParameters<Scalar>& p, const FourWheelOptions& options = {}) {
  const Scalar trail(0.03);
  const LinearTyre<Scalar> front{.stiffness = p.C_f, .mu = p.mu, .pneumatic_trail = trail};
  const LinearTyre<Scalar> rear{.stiffness = p.C_r, .mu = p.mu, .pneumatic_trail = trail};
  return {p, {front, front, rear, rear}, options};
}

[[nodiscard]] inline FourWheelOptions with_longitudinal(const LongitudinalParameters& longitudinal) {
  FourWheelOptions options;
  options.longitudinal = longitudinal;
  return options;
}

/// The reference car on springs and tyres as stiff as those of a car on the road.
inline VehicleParameters<double> road_car() {
  VehicleParameters<double> p;
  p.K_sf = 31000.0;
  p.K_sr = 27000.0;
  p.C_sf = 2500.0;
  p.C_sr = 2100.0;
  p.K_tf = p.K_tr = 200000.0;
  return p;
}

}  // namespace veridyn::vehicle::testing
