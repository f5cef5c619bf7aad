#pragma once

#include <Eigen/Core>

#include "veridyn/numerics/trigonometry.hpp"
#include "veridyn/vehicle/tyre/wheel_arrays.hpp"

namespace veridyn::vehicle {

/// Where each state is in a `FourWheelState`. Per-wheel states follow one another in wheel order.
enum FourWheelIndex : Eigen::Index {
  kX,                                   ///< centre of gravity, earth axes [m]
  kY,                                   ///< [m]
  kYaw,                                 ///< [rad]
  kU,                                   ///< forward speed [m/s]
  kV,                                   ///< leftward speed [m/s]
  kR,                                   ///< yaw rate [rad/s]
  kHeave,                               ///< of the sprung mass's centre of gravity above its rest [m]
  kRoll,                                ///< left side up positive [rad]
  kPitch,                               ///< nose down positive [rad]
  kHeaveRate,                           ///< [m/s]
  kRollRate,                            ///< [rad/s]
  kPitchRate,                           ///< [rad/s]
  kWheelHeight,                         ///< 4: of the unsprung masses above their rest [m]
  kWheelHeightRate = kWheelHeight + 4,  ///< 4: [m/s]
  kDistance = kWheelHeightRate + 4,     ///< travelled by the centre of gravity on its path [m]
  kWheelSpin,                           ///< 4: [rad/s]; at rest without longitudinal dynamics
  kLaggedSlip = kWheelSpin + 4,         ///< 4: slip angles [rad]; at rest without relaxation length
  kFourWheelStates = kLaggedSlip + 4
};
/// State vector of the model; `FourWheelIndex` names its entries.
template <typename Scalar>
using FourWheelState = Eigen::Matrix<Scalar, kFourWheelStates, 1>;

/// Below this speed of a wheel [m/s] the slip angle is what it would be at it: that of a standing wheel has no meaning.
inline constexpr double kLeastSpeedOfAngle = 1e-6;
/// The same for the slip ratio [m/s].
inline constexpr double kLeastSpeedOfRatio = 0.5;

/// The controls as they reach the wheels; the same for all derivatives at one time.
template <typename Scalar>
struct WheelControls {
  WheelArray<Scalar> steer;  ///< [rad]
  WheelArray<Scalar> cos, sin;
  WheelArray<double> drive, brake;  ///< torques [N m]

  /// Each wheel turned further to the left [rad]; forces turn with it where `exact`.
  void turn(const WheelArray<Scalar>& by, bool exact);
};

/// Rates and forces at one moment.
template <typename Scalar>
struct FourWheelRates {
  FourWheelState<Scalar> derivative;
  Scalar longitudinal_acceleration{0.0};  ///< u' - r v [m/s^2]
  Scalar lateral_acceleration{0.0};       ///< v' + r u [m/s^2]
  /// Constant speed only: the force that keeps u as it is, along the vehicle, at the road [N]; 0 otherwise.
  Scalar holding_force{0.0};
  WheelArray<Scalar> slip_angle;  ///< at which the tyre works [rad]
  WheelArray<Scalar> slip_ratio;
  WheelArray<Scalar> Fx, Fy;                ///< wheel axes [N]
  WheelArray<Scalar> Fz;                    ///< normal force, static load included; 0 off the ground [N]
  WheelArray<Scalar> suspension_travel;     ///< wheel less body corner: bump positive [m]
  WheelArray<Scalar> suspension_force;      ///< of springs, dampers and bars on the body, less its static value [N]
  WheelArray<Scalar> contact_x, contact_y;  ///< velocity of the contact point, vehicle axes [m/s]
  /// What roll, travel and lateral force add to the steer of each wheel [rad]; 0 where nothing does.
  WheelArray<Scalar> suspension_steer = WheelArray<Scalar>::Constant(Scalar(0.0));
  /// To the left [N m]; 0 where the model leaves it out.
  WheelArray<Scalar> aligning_moment = WheelArray<Scalar>::Constant(Scalar(0.0));
};

template <typename Scalar>
void WheelControls<Scalar>::turn(const WheelArray<Scalar>& by, bool exact) {
  steer += by;
  if (!exact) return;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const numerics::SineCosine<Scalar> at = numerics::sine_cosine<Scalar>(by[i]);
    const Scalar c = cos[i], s = sin[i];
    cos[i] = c * at.cos - s * at.sin;
    sin[i] = s * at.cos + c * at.sin;
  }
}

}  // namespace veridyn::vehicle
