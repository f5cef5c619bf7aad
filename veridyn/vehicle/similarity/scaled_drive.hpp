#pragma once

#include "veridyn/vehicle/model/driver.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"
#include "veridyn/vehicle/road/road.hpp"
#include "veridyn/vehicle/similarity/similarity.hpp"

namespace veridyn::vehicle {

/// View of a prototype's driver, as the driver of its scaled model: does at the model's time what the prototype's
/// driver does at the prototype's, looks at the motion in the prototype's size and turns torques into the model's.
class ScaledDriver : public Driver {
 public:
  /// @param driver outlives this
  /// @param factors model over prototype
  ScaledDriver(Driver& driver, const ScaleFactors& factors) : driver_(driver), factors_(factors) {}

  void look(double time, const PlanarMotion& motion) override;
  [[nodiscard]] Controls controls(double time) const override;

 private:
  Driver& driver_;
  ScaleFactors factors_;
};

/// View of a road with all lengths and heights times a factor.
class ScaledRoad : public Road {
 public:
  /// @param road outlives this
  ScaledRoad(const Road& road, double length) : road_(road), length_(length) {}
  [[nodiscard]] double height(const RoadPoint& point) const override;

 private:
  const Road& road_;
  double length_;
};

/// Every number with a unit times its factor: the exactly similar vehicle, tyres (also their nominal loads) and
/// longitudinal dynamics included.
[[nodiscard]] Vehicle scaled(const Vehicle& vehicle, const ScaleFactors& factors);

}  // namespace veridyn::vehicle
