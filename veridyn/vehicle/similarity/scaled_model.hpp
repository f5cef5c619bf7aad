#pragma once

#include <concepts>

#include "veridyn/vehicle/model/four_wheel_models.hpp"
#include "veridyn/vehicle/similarity/similarity.hpp"

namespace veridyn::vehicle {

// Tyres and options of an exactly similar vehicle: together with `scaled(parameters, factors)` the four-wheel model of
// the twin. Coefficients of friction and shape are plain numbers and stay. Loads scale with force, so that a tyre whose
// stiffness depends on its load works at the same point of its curve where weight scales with force: for a Froude twin,
// or under `ScaledVehicle::similar_gravity`.

/// The tyre of the scaled vehicle.
template <typename Tyre>
requires requires(const Tyre& tyre) {
  { tyre.scaled(1.0, 1.0) } -> std::same_as<Tyre>;
}
[[nodiscard]] Tyre scaled(const Tyre& tyre, const ScaleFactors& factors) {
  return tyre.scaled(factors.force(), factors.length);
}

/// The axle of the scaled vehicle.
[[nodiscard]] inline AxleSuspension scaled(AxleSuspension axle, const ScaleFactors& factors) {
  axle.roll_centre *= factors.length;
  axle.bump_steer /= factors.length;
  axle.compliance_steer /= factors.force();
  axle.spring = axle.spring.scaled(factors.length, factors.force());
  return axle;
}

/// The air is the same: the areas make up for it.
[[nodiscard]] inline AerodynamicLift scaled(AerodynamicLift lift, const ScaleFactors& factors) {
  lift.area_f *= factors.of("kg/m");
  lift.area_r *= factors.of("kg/m");
  return lift;
}

/// Gravity scales as an acceleration: put the real one back to see what an unscaled weight does.
[[nodiscard]] inline FourWheelOptions scaled(FourWheelOptions options, const ScaleFactors& factors) {
  options.gravity *= factors.acceleration();
  options.relaxation_length *= factors.length;
  options.suspension_f = scaled(options.suspension_f, factors);
  options.suspension_r = scaled(options.suspension_r, factors);
  options.lift = scaled(options.lift, factors);
  if (options.longitudinal) {
    LongitudinalParameters& l = *options.longitudinal;
    l.wheel_radius *= factors.length;
    l.wheel_inertia *= factors.of("kg m^2");
    // The air is the same: the area makes up for it.
    l.drag_area *= factors.of("kg/m");
  }
  return options;
}

/// The scaled vehicle.
template <typename Tyre>
[[nodiscard]] FourWheelModel<double, Tyre> scaled(const FourWheelModel<double, Tyre>& model,
                                                  const ScaleFactors& factors) {
  PerWheel<Tyre> tyres = model.tyres();
  for (Tyre& tyre : tyres) tyre = scaled(tyre, factors);
  return {scaled(model.parameters(), factors), tyres, scaled(model.options(), factors)};
}

/// The scaled vehicle.
template <typename Tyre>
[[nodiscard]] BicycleModel<double, Tyre> scaled(const BicycleModel<double, Tyre>& model, const ScaleFactors& factors) {
  return {scaled(model.parameters, factors), scaled(model.front, factors), scaled(model.rear, factors),
          model.gravity * factors.acceleration(), model.geometry};
}

}  // namespace veridyn::vehicle
