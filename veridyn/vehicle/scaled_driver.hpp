#pragma once

#include "veridyn/vehicle/driver.hpp"
#include "veridyn/vehicle/road.hpp"
#include "veridyn/vehicle/similarity.hpp"

namespace veridyn::vehicle {

/// The driver of one size in a vehicle of another: sees the motion as the prototype's and acts on the prototype's time
/// axis. Steering angles are the same; torques scale as force times length.
class ScaledDriver : public Driver {
 public:
  /// `factors`: the driven vehicle over the one that `driver` is made for. `driver` must outlive this.
  ScaledDriver(Driver& driver, const ScaleFactors& factors) : driver_(driver), factors_(factors) {}

  void look(double time, const PlanarMotion& motion) override {
    driver_.look(time / factors_.time(), {.x = motion.x / factors_.length,
                                          .y = motion.y / factors_.length,
                                          .yaw = motion.yaw,
                                          .u = motion.u / factors_.speed,
                                          .v = motion.v / factors_.speed,
                                          .r = motion.r * factors_.time()});
  }
  [[nodiscard]] Controls controls(double time) const override {
    const Controls c = driver_.controls(time / factors_.time());
    const double torque = factors_.force() * factors_.length;
    return {c.steer, torque * c.drive_torque, torque * c.brake_torque};
  }

 private:
  Driver& driver_;
  ScaleFactors factors_;
};

/// A road whose lengths and heights are those of another times the factor of length.
class ScaledRoad : public Road {
 public:
  /// `road` must outlive this.
  ScaledRoad(const Road& road, double length) : road_(road), length_(length) {}

  [[nodiscard]] double height(const RoadPoint& point) const override {
    return length_ * road_.height({.x = point.x / length_,
                                   .y = point.y / length_,
                                   .distance = point.distance / length_,
                                   .offset = point.offset / length_});
  }

 private:
  const Road& road_;
  double length_;
};

}  // namespace veridyn::vehicle
