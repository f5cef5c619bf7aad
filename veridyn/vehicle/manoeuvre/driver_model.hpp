#pragma once

#include <memory>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/manoeuvre/path.hpp"
#include "veridyn/vehicle/manoeuvre/piecewise_linear.hpp"
#include "veridyn/vehicle/model/bicycle_analysis.hpp"
#include "veridyn/vehicle/model/driver.hpp"

namespace veridyn::vehicle {

/// Options of a driver who looks ahead.
struct PreviewDriverOptions {
  /// How far ahead the error is weighed [s]. About 1 s fits people (MacAdam 1981); shorter follows closer and needs
  /// more lateral acceleration, longer cuts corners. 1.0 keeps the lanes of ISO 3888-1 at 80 km/h, 1.3 does not.
  double preview_time = 1.0;
  double delay = 0.2;               ///< transport delay of eye, brain and arm [s]
  double lag = 0.0;                 ///< first-order lag of arms and steering after the delay [s]
  double max_steer = 0.6;           ///< at the road wheels [rad]
  double max_steer_rate = 1.0;      ///< at the road wheels [rad/s]; 1 rad/s is 900 deg/s at a hand wheel of ratio 16
  double decision_interval = 0.01;  ///< between decisions [s]
  int preview_points = 25;

  /// @throws InputError naming the option.
  void validate() const;
};

/// The optimal preview driver of MacAdam (1981, IEEE Trans. SMC 11:393): chooses the constant steer that would minimise
/// the mean squared lateral distance between path and predicted motion over the preview time,
///
///     delta = integral (f(eta) - y_0(eta)) G(eta) d eta / integral G(eta)^2 d eta
///
/// where y_0 is the linear bicycle's lateral motion from the present state with zero steer, G its response to a unit
/// step of steer and f the path, and applies it after a delay. Path and motion are taken relative to the path's tangent
/// at the nearest point, the path straightened out (f'' = u^2 curvature), so that full circles can be followed. On a
/// circle with a perfect internal model the error goes to zero.
///
/// It has a state: one driver for one vehicle. A look at an earlier time than the last starts it afresh.
class PreviewDriver : public Driver {
 public:
  /// `bicycle` is what the driver expects of the vehicle; its speed is replaced by the present one.
  PreviewDriver(LinearBicycle<double> bicycle, std::shared_ptr<const Path> path, PreviewDriverOptions options = {});

  void look(double time, const PlanarMotion& motion) override;
  [[nodiscard]] Controls controls(double time) const override;

 private:
  void predict(double u);
  [[nodiscard]] double decide(const PlanarMotion& motion);
  void record(double time, double steer);

  LinearBicycle<double> bicycle_;
  std::shared_ptr<const Path> path_;
  PreviewDriverOptions options_;
  // Prediction for the speed `predicted_speed_`, a value per preview point.
  double predicted_speed_ = 0.0;
  double step_ = 0.0;
  std::vector<double> from_v_, from_r_, from_steer_, weight_;
  std::vector<double> history_time_, history_steer_;  // ring buffers of decisions, before the delay
  std::size_t history_begin_ = 0, history_size_ = 0;
  double last_decision_ = -kInfinity;
  double s_ = 0.0;
  double lateral_error_ = 0.0;
  bool started_ = false;
};

/// Keeps a speed with drive and brake torque: T = R_w m (K_p e + K_i integral e), limited, its integral stopped while
/// the limit acts.
struct SpeedControllerOptions {
  double mass = 1100.0;           ///< [kg]
  double wheel_radius = 0.3;      ///< [m]
  double proportional = 1.0;      ///< acceleration per error [1/s]
  double integral = 0.1;          ///< [1/s^2]
  double max_acceleration = 3.0;  ///< of the drive torque [m/s^2]
  double max_deceleration = 6.0;  ///< of the brakes [m/s^2]

  /// @throws InputError naming the option.
  void validate() const;
};

/// Steers as another driver and holds a speed over time.
class SpeedControlledDriver : public Driver {
 public:
  SpeedControlledDriver(std::unique_ptr<Driver> steering, PiecewiseLinear speed, SpeedControllerOptions options);
  void look(double time, const PlanarMotion& motion) override;
  [[nodiscard]] Controls controls(double time) const override;

 private:
  std::unique_ptr<Driver> steering_;
  PiecewiseLinear speed_;
  SpeedControllerOptions options_;
  double torque_ = 0.0;
  double integral_ = 0.0;
  double last_ = kInfinity;
};

}  // namespace veridyn::vehicle
