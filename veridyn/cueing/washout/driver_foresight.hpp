#pragma once

#include "veridyn/core/cloned.hpp"
#include "veridyn/cueing/washout/foresight.hpp"
#include "veridyn/vehicle/simulation/stepped_vehicle.hpp"

namespace veridyn::cueing {

/// Forces from what the driver does: a model of the vehicle runs along, its speed and yaw rate kept at the measured
/// ones where these are known, and goes on with steering and pedals held. Without steering nothing is foreseen.
///
/// The four-wheel model answers the steering. What torques, drag and rolling resistance do along the way is the balance
/// of their forces with wheels that roll, up to the friction: stepping the wheels' spin as well would take ten times as
/// long, and at walking pace much longer.
class DriverForesight final : public Foresight {
 public:
  /// @throws InputError as `vehicle::stepped_vehicle`.
  explicit DriverForesight(const vehicle::Vehicle& vehicle);

  void reset() override { runs_ = false; }
  bool look(const recording::MotionSample& sample, double step, Foreseen& foreseen) override;
  [[nodiscard]] std::unique_ptr<Foresight> clone() const override { return std::make_unique<DriverForesight>(*this); }
  [[nodiscard]] std::string from() const override { return "the driver's steering and pedals"; }

 private:
  [[nodiscard]] double acceleration(const vehicle::Controls& controls, double speed) const;
  void set_speed(double speed);
  [[nodiscard]] Eigen::Vector3d force(const vehicle::Controls& controls, const Eigen::Vector3d& place) const;

  Cloned<vehicle::SteppedVehicle> vehicle_;
  vehicle::LongitudinalParameters longitudinal_;
  double mass_, weight_, grip_;  ///< with the wheels' inertia [kg], [N], largest force along the way [N]
  double speed_ = 0.0;           ///< [m/s]
  bool runs_ = false, knows_torques_ = false;
  double since_ahead_ = 0.0;  ///< [s]
  Foreseen last_;
};

}  // namespace veridyn::cueing
