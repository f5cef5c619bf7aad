#include "veridyn/vehicle/similarity/scaled_drive.hpp"

#include "veridyn/vehicle/similarity/scaled_model.hpp"

namespace veridyn::vehicle {
void ScaledDriver::look(double time, const PlanarMotion& motion) {
  PlanarMotion of_prototype = motion;
  of_prototype.x /= factors_.length;
  of_prototype.y /= factors_.length;
  of_prototype.u /= factors_.speed;
  of_prototype.v /= factors_.speed;
  of_prototype.r *= factors_.time();
  driver_.look(time / factors_.time(), of_prototype);
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
  const double length = factors.length;
  std::visit(
      [&](auto& tyres) {
        tyres.front = scaled(tyres.front, factors);
        tyres.rear = scaled(tyres.rear, factors);
      },
      model.tyres);
  LongitudinalParameters& l = model.longitudinal;
  l.wheel_radius *= length;
  l.wheel_inertia *= factors.of("kg m^2");
  // The air is the same: the area makes up for it.
  l.drag_area *= factors.of("kg/m");
  model.relaxation_length *= length;
  model.suspension_f = scaled(vehicle.suspension_f, factors);
  model.suspension_r = scaled(vehicle.suspension_r, factors);
  model.lift = scaled(vehicle.lift, factors);
  if (model.speed) model.speed = *model.speed * factors.speed;
  return model;
}

}  // namespace veridyn::vehicle
