#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

#include "veridyn/vehicle/bicycle_model.hpp"
#include "veridyn/vehicle/driver.hpp"
#include "veridyn/vehicle/longitudinal.hpp"
#include "veridyn/vehicle/tyre.hpp"
#include "veridyn/vehicle/vehicle_parameters.hpp"
#include "veridyn/vehicle/wheels.hpp"

namespace veridyn::vehicle {

/// Where each state stands in a `FourWheelState`. Per-wheel states follow one another in wheel order.
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
  kWheelSpin = kWheelHeightRate + 4,    ///< 4: [rad/s]; at rest without longitudinal dynamics
  kLaggedSlip = kWheelSpin + 4,         ///< 4: slip angles [rad]; at rest without relaxation length
  kDistance = kLaggedSlip + 4,          ///< travelled by the centre of gravity on its path [m]
  kFourWheelStates
};
template <typename Scalar>
using FourWheelState = Eigen::Matrix<Scalar, kFourWheelStates, 1>;

/// Which equations of motion.
enum class FourWheelConvention {
  /// From first principles, the default: the sprung mass moves in heave and gravity tilts it; energy is conserved.
  kFirstPrinciples,
  /// The similarity study whose curves `veridyn reproduce vehicle` draws again: the whole mass in heave and four
  /// unsprung masses in addition; vertical forces are deviations from the static load, so that gravity does not tilt
  /// the body and tyres may pull; contact points do not move with roll and pitch.
  kSource
};

struct FourWheelOptions {
  FourWheelConvention convention = FourWheelConvention::kFirstPrinciples;
  /// kSmallAngles: slip angle delta - V_y/V_x and forces not turned by delta.
  BicycleGeometry geometry = BicycleGeometry::kExact;
  double gravity = 9.80665;  ///< [m/s^2]
  /// 0: both front wheels steered alike; 1: Ackermann, their axes meet on the line of the rear axle. Between: linear.
  double ackermann = 0.0;
  double camber_per_roll = 0.0;  ///< inclination of the wheels as a share of the body's roll
  /// Distance rolled in which the slip angle follows by 63 % [m]; 0: at once.
  double relaxation_length = 0.0;
  /// Without: u stays as it is, at the cost of `FourWheelRates::holding_force`, and wheels roll freely.
  std::optional<LongitudinalParameters> longitudinal{};

  /// Throws InputError("vehicle", ...) naming the first option that makes no sense.
  void validate() const;
};

/// The controls as they reach the wheels; the same for all derivatives at one time.
template <typename Scalar>
struct WheelControls {
  std::array<Scalar, 2> steer{};  ///< of the front wheels, left and right [rad]
  std::array<Scalar, 2> cos{};
  std::array<Scalar, 2> sin{};
  std::array<double, 2> drive{};  ///< torque on one wheel, front and rear [N m]
  std::array<double, 2> brake{};  ///< [N m]
};

/// What the model says about one moment.
template <typename Scalar>
struct FourWheelRates {
  FourWheelState<Scalar> derivative;
  Scalar longitudinal_acceleration{0.0};  ///< u' - r v [m/s^2]
  Scalar lateral_acceleration{0.0};       ///< v' + r u [m/s^2]
  /// Constant speed only: the force that keeps u as it is, along the vehicle, at the road [N]; 0 otherwise.
  Scalar holding_force{0.0};
  PerWheel<Scalar> slip_angle{};  ///< that the tyre feels [rad]
  PerWheel<Scalar> slip_ratio{};
  PerWheel<Scalar> Fx{}, Fy{};                ///< wheel axes [N]
  PerWheel<Scalar> Fz{};                      ///< normal force, static load included; 0 off the ground [N]
  PerWheel<Scalar> suspension_travel{};       ///< wheel less body corner: bump positive [m]
  PerWheel<Scalar> suspension_force{};        ///< on the body, less its static value [N]
  PerWheel<Scalar> contact_x{}, contact_y{};  ///< velocity of the contact point, vehicle axes [m/s]
};

/// The four-wheel model: the body in the plane (x, y, yaw) and in heave, roll and pitch, and four unsprung masses that
/// move up and down between suspension and tyre. Its derivation is in docs/vehicle.md, "Four-wheel model".
///
/// Our convention (`FourWheelConvention::kFirstPrinciples`)
/// - `mass` is the whole vehicle: lateral, longitudinal and yaw motion use it, and I_z. The sprung mass
///   m_s = m - 4 M_w moves in heave, with I_x and I_y about its own centre of gravity. All mass is at one height c.
///   The wheels' masses sit at the axles, so the sprung centre of gravity is x_s = 2 M_w (b - a)/m_s ahead of the
///   whole one; arms below are measured from there, and static tyre loads are m g b/(2 L) and m g a/(2 L).
/// - Exact planar motion, small roll and pitch. Height of a corner to second order, less its rest,
///       z_i = z + y_i roll - x_i pitch + c/2 (roll^2 + pitch^2)
///   and all generalised forces by virtual work from it: gravity's tilting moment m_s g c roll comes from the static
///   corner loads. No gyroscopic terms (of order r roll'): good up to about 15 deg of roll and pitch.
/// - Suspension: F_i = static + K_s (z_w - z_i) + C_s (z_w' - z_i') + K_b (travel_i - travel_opposite), both ways.
/// - Tyre: F_z = max(0, static + K_t (z_road - z_w)): it cannot pull.
/// - Tyre forces act at the road: contact velocities V_x = u - y_i r - c pitch', V_y = v + x_i r + c roll' make slips,
///   and the same arms make moments: the power of the tyres is force times contact velocity. Aligning moments are
///   neglected.
/// - At constant speed the force that holds u acts at the road too and pitches the body.
///
/// Left and right are treated alike to the last bit: mirrored steering, road and state give mirrored rates.
/// `tyres[i]` serves wheel i (side-dependent tyres come in mirrored copies). Usable with double and ceres::Jet; the
/// functions do not allocate.
template <typename Scalar, typename Tyre>
class FourWheelModel {
 public:
  using State = FourWheelState<Scalar>;

  /// Throws InputError("vehicle", ...) on inadmissible options; `parameters` must be admissible.
  FourWheelModel(const VehicleParameters<Scalar>& parameters, const PerWheel<Tyre>& tyres,
                 const FourWheelOptions& options = {});

  /// Upright and at rest in its springs at the origin, driving straight ahead at `speed`, wheels rolling freely.
  [[nodiscard]] State steady_start(const Scalar& speed) const;

  /// Steer angles and torques of the wheels.
  [[nodiscard]] WheelControls<Scalar> wheel_controls(const Scalar& steer, double drive_torque = 0.0,
                                                     double brake_torque = 0.0) const;
  [[nodiscard]] WheelControls<Scalar> wheel_controls(const Controls& controls) const {
    return wheel_controls(Scalar(controls.steer), controls.drive_torque, controls.brake_torque);
  }

  /// Derivative and forces at `state` over a road of the heights `road` under the wheels.
  void rates(const State& state, const WheelControls<Scalar>& controls, const PerWheel<double>& road,
             FourWheelRates<Scalar>& out) const;

  /// Kinetic energy and the potential energy of springs, tyres and gravity, 0 at rest [J]. First principles only.
  /// Its derivative is the power of the tyre forces at the contact points, of the road pushing up, of the holding
  /// force or of drag and grade, less that of the dampers; spin energy of the wheels is not in it.
  [[nodiscard]] Scalar energy(const State& state, const PerWheel<double>& road) const;

  /// Position of a wheel from the vehicle's centre of gravity, x forward, y left [m].
  [[nodiscard]] Scalar wheel_x(std::size_t wheel) const { return is_front(wheel) ? p_.a : Scalar(-p_.b); }
  [[nodiscard]] Scalar wheel_y(std::size_t wheel) const {
    const Scalar half = 0.5 * (is_front(wheel) ? p_.track_f : p_.track_r);
    return is_left(wheel) ? half : Scalar(-half);
  }

  [[nodiscard]] const VehicleParameters<Scalar>& parameters() const { return p_; }
  [[nodiscard]] const PerWheel<Tyre>& tyres() const { return tyres_; }
  [[nodiscard]] const FourWheelOptions& options() const { return options_; }
  [[nodiscard]] const PerWheel<Scalar>& rest_loads() const { return rest_load_; }

 private:
  VehicleParameters<Scalar> p_;
  PerWheel<Tyre> tyres_;
  FourWheelOptions options_;
  PerWheel<Scalar> rest_load_{};
};

}  // namespace veridyn::vehicle
