#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "veridyn/recording/motion_sample.hpp"
#include "veridyn/vehicle/model/driver.hpp"
#include "veridyn/vehicle/model/four_wheel_model.hpp"
#include "veridyn/vehicle/road/road.hpp"

namespace veridyn::vehicle {

/// Contact speed of a wheel [m/s] up to which its slip is that of its deflection; from there it goes over to the
/// steady one.
inline constexpr double kStandingSpeed = 0.5;
/// The upper one: from here on a step is that of `simulate`.
inline constexpr double kRollingSpeed = 2.0;

/// All that a stepped drive remembers: a copy restores it bit for bit.
struct DriveState {
  double time = 0.0;  ///< [s]
  FourWheelState<double> vehicle = FourWheelState<double>::Zero();
  /// How far the contact patches are behind the wheels, forward and leftward [m]: what holds a standing car.
  WheelArray<double> deflection_x = WheelArray<double>::Zero(), deflection_y = WheelArray<double>::Zero();
  Controls controls;         ///< of the last step
  bool rolled_over = false;  ///< roll or pitch is held at 45 deg, beyond which the model does not go
  long refused = 0;          ///< steps not made, or made with the last controls: their numbers were out of range
};

/// A vehicle driven from outside, one step at a time: from rest, forward, backward, to a stop, parked on a grade, and
/// on after a spin. Where every wheel's contact moves at `kRollingSpeed` or faster a step is that of `simulate`, bit
/// for bit. Slower, and with longitudinal dynamics, slips come from the deflection e of the tyre (single contact point:
/// Pacejka, Tyre and Vehicle Dynamics, 3rd ed. (2012), sections 7.2 and 8.6),
///
///     e_x' = R omega - V_x - |V_x| e_x/sigma     kappa = e_x/sigma + d_x (R omega - V_x)
///     e_y' = -V_y - |V_x| e_y/sigma              tan alpha = e_y/sigma - d_y V_y
///
/// which is a spring with a damper where nothing rolls, and the steady slip where it rolls evenly. sigma is the model's
/// relaxation length, else a third of the wheel's radius; d damps the standing vehicle by half the critical value;
/// deflections end where the force would be three static loads. In between, steady and deflected slips are blended.
///
/// Compiled for the tyres that `simulate` is. `step` does not allocate, throw or read a clock; no state is ever NaN.
template <typename Tyre>
class SteppedDrive {
 public:
  using Model = FourWheelModel<double, Tyre>;

  /// `road` may be null: flat. Throws InputError("vehicle", ...) on inadmissible parameters, and on small-angle
  /// geometry with longitudinal dynamics, whose slip has no value at rest; InputError("drive", ...) on a model that no
  /// step of 1e-6 s or longer follows.
  /// @param usual_speed at which the fastest motion is looked for: `simulate` takes its starting speed [m/s]
  explicit SteppedDrive(const Model& model, std::shared_ptr<const Road> road = nullptr, double usual_speed = 20.0);

  /// Starts again, upright and straight ahead at `speed` [m/s], which may be 0 or negative (with longitudinal
  /// dynamics).
  void reset(double speed = 0.0);
  /// Goes on from a saved state.
  void reset(const DriveState& state);
  /// Goes on from a state in another field of accelerations, see `FourWheelModel::set_field`.
  void reset(const DriveState& state, const Eigen::Vector3d& field, const Eigen::Vector2d& turning);

  /// Drives on for `dt` [s] with these controls held. Long steps are cut into parts that the vehicle's stiffness bears
  /// (at most 1 s a step). Controls out of range (NaN, steer beyond 90 deg, negative brake) leave the last ones; a `dt`
  /// not above 0 leaves all as it is: both are counted.
  void step(const Controls& controls, double dt) noexcept;

  [[nodiscard]] const DriveState& state() const { return state_; }
  /// Rates, slips and forces of the wheels at the end of the last step.
  [[nodiscard]] const FourWheelRates<double>& rates() const { return rates_; }
  [[nodiscard]] const Model& model() const { return model_; }

  /// The motion in all six directions at a place of the sprung body, flu. @param place from the centre of gravity [m]
  ///
  /// Attitude: heading, grade, then pitch and roll. The yaw rate is about the road's normal, gravity square to the
  /// road is counted, so that a car parked on a grade shows g sin(grade) forward. What a field adds is not felt.
  [[nodiscard]] recording::MotionSample motion(const Eigen::Vector3d& place = Eigen::Vector3d::Zero()) const;

 private:
  struct Standing {
    WheelArray<double> x, y;  ///< deflections, or their rates [m], [m/s]
  };
  void evaluate() noexcept;
  [[nodiscard]] bool rolls() const;
  [[nodiscard]] PerWheel<double> under(const FourWheelState<double>& state) const;
  void slow_rates(const FourWheelState<double>& state, const Standing& standing, FourWheelRates<double>& rates,
                  Standing& change) const;
  void slow_step(double h) noexcept;
  void part(double h) noexcept;
  void hold_limits(const DriveState& before) noexcept;
  void follow_steady_slip() noexcept;

  Model model_;
  std::shared_ptr<const Road> road_;
  bool spins_ = false;
  double spins_rate_speed_ = 0.0;  ///< rate times speed of the motion in the plane [m/s^2]
  double standing_rate_ = 0.0;     ///< of the deflected tyres [1/s]
  double longest_step_ = 0.0;
  double sigma_ = 0.1;                            ///< [m]
  WheelArray<double> most_ratio_, most_tangent_;  ///< largest slips by deflection
  WheelArray<double> damping_x_, damping_y_;      ///< d [s/m]
  DriveState state_;
  WheelControls<double> at_wheels_;
  FourWheelRates<double> rates_;
};

}  // namespace veridyn::vehicle
