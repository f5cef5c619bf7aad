#include "veridyn/vehicle/scaled_drive.hpp"

namespace veridyn::vehicle {
namespace {

template <typename Tyre>
Tyre scaled_tyre(Tyre tyre, double force) {
  tyre.stiffness *= force;
  tyre.slip_stiffness *= force;
  if constexpr (requires { tyre.nominal_load; }) tyre.nominal_load *= force;
  return tyre;
}

MagicFormulaTyre<double> scaled_tyre(MagicFormulaTyre<double> tyre, double force, double length) {
  // All other coefficients are dimensionless.
  tyre.coefficients.FNOMIN *= force;
  tyre.coefficients.UNLOADED_RADIUS *= length;
  tyre.range.load_min *= force;
  tyre.range.load_max *= force;
  return tyre;
}

}  // namespace

void ScaledDriver::look(double time, const PlanarMotion& motion) {
  PlanarMotion seen = motion;
  seen.x /= factors_.length;
  seen.y /= factors_.length;
  seen.u /= factors_.speed;
  seen.v /= factors_.speed;
  seen.r *= factors_.time();
  driver_.look(time / factors_.time(), seen);
}

Controls ScaledDriver::controls(double time) const {
  Controls c = driver_.controls(time / factors_.time());
  const double torque = factors_.force() * factors_.length;
  c.drive_torque *= torque;
  c.brake_torque *= torque;
  return c;
}

double ScaledRoad::height(const RoadPoint& point) const {
  return length_ * road_.height({.x = point.x / length_,
                                 .y = point.y / length_,
                                 .distance = point.distance / length_,
                                 .offset = point.offset / length_});
}

Vehicle scaled(const Vehicle& vehicle, const ScaleFactors& factors) {
  Vehicle model = vehicle;
  model.parameters = scaled(vehicle.parameters, factors);
  const double force = factors.force(), length = factors.length;
  std::visit(
      [&]<typename Tyre>(AxleTyres<Tyre>& tyres) {
        for (Tyre* tyre : {&tyres.front, &tyres.rear}) {
          if constexpr (std::is_same_v<Tyre, MagicFormulaTyre<double>>) {
            *tyre = scaled_tyre(*tyre, force, length);
          } else {
            *tyre = scaled_tyre(*tyre, force);
          }
        }
      },
      model.tyres);
  LongitudinalParameters& l = model.longitudinal;
  l.wheel_radius *= length;
  l.wheel_inertia *= factors.of("kg m^2");
  // The air is the same: the area makes up for it.
  l.drag_area *= factors.of("kg/m");
  model.relaxation_length *= length;
  if (model.speed) model.speed = *model.speed * factors.speed;
  return model;
}

}  // namespace veridyn::vehicle
