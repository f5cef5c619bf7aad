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

/// Below these speeds of a wheel [m/s] slip is what it would be at them: slips of a standing wheel have no meaning.
inline constexpr double kLeastSpeedOfAngle = 1e-6;
inline constexpr double kLeastSpeedOfRatio = 0.5;

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

  /// Friction that holds the spin of a wheel: brake and rolling resistance [N m].
  [[nodiscard]] Scalar spin_friction(std::size_t wheel, const WheelControls<Scalar>& controls,
                                     const Scalar& load) const;

 private:
  /// What one axle has, with what does not change precomputed.
  struct Axle {
    Scalar x{0.0};       ///< ahead of the vehicle's centre of gravity [m]
    Scalar arm{0.0};     ///< ahead of the sprung mass's [m]
    Scalar half{0.0};    ///< half the track [m]
    Scalar spring{0.0};  ///< [N/m]
    Scalar damper{0.0};  ///< [N s/m]
    Scalar bar{0.0};     ///< [N/m]
    Scalar tyre{0.0};    ///< [N/m]
    Scalar rest{0.0};    ///< static load of one tyre [N]
  };

  VehicleParameters<Scalar> p_;
  PerWheel<Tyre> tyres_;
  FourWheelOptions options_;
  PerWheel<Scalar> rest_load_{};
  std::array<Axle, 2> axles_{};
  Scalar heaving_mass_{0.0};  ///< [kg]
  Scalar tilting_{0.0};       ///< m_s g c [N m/rad]; 0 in the source's convention
  Scalar second_order_{0.0};  ///< c, or 0 in the source's convention
  Scalar contact_arm_{0.0};   ///< c, or 0 in the source's convention
  Scalar per_mass_{0.0}, per_heaving_mass_{0.0}, per_unsprung_mass_{0.0};  ///< inverses
  Scalar per_I_x_{0.0}, per_I_y_{0.0}, per_I_z_{0.0};
  double gravity_across_ = 0.0;  ///< square to the road [m/s^2]
  double gravity_along_ = 0.0;   ///< down the grade [m/s^2]
};

template <typename Scalar, typename Tyre>
FourWheelModel<Scalar, Tyre>::FourWheelModel(const VehicleParameters<Scalar>& parameters, const PerWheel<Tyre>& tyres,
                                             const FourWheelOptions& options)
    : p_(parameters), tyres_(tyres), options_(options) {
  options.validate();
  const bool ours = options.convention == FourWheelConvention::kFirstPrinciples;
  const double grade = options.longitudinal ? options.longitudinal->grade : 0.0;
  gravity_across_ = options.gravity * std::cos(grade);
  gravity_along_ = options.gravity * std::sin(grade);
  rest_load_ = static_loads(p_, gravity_across_);
  const Scalar sprung = p_.mass - 4.0 * p_.unsprung_mass;
  const Scalar x_s = ours ? Scalar(2.0 * p_.unsprung_mass * (p_.b - p_.a) / sprung) : Scalar(0.0);
  axles_[0] = {p_.a, p_.a - x_s, 0.5 * p_.track_f, p_.K_sf, p_.C_sf, p_.K_bf, p_.K_tf, rest_load_[kFrontLeft]};
  axles_[1] = {-p_.b, -p_.b - x_s, 0.5 * p_.track_r, p_.K_sr, p_.C_sr, p_.K_br, p_.K_tr, rest_load_[kRearLeft]};
  heaving_mass_ = ours ? sprung : p_.mass;
  tilting_ = ours ? Scalar(sprung * gravity_across_ * p_.cg_height) : Scalar(0.0);
  second_order_ = ours ? p_.cg_height : Scalar(0.0);
  contact_arm_ = second_order_;
  per_mass_ = 1.0 / p_.mass;
  per_heaving_mass_ = 1.0 / heaving_mass_;
  per_unsprung_mass_ = 1.0 / p_.unsprung_mass;
  per_I_x_ = 1.0 / p_.I_x;
  per_I_y_ = 1.0 / p_.I_y;
  per_I_z_ = 1.0 / p_.I_z;
}

template <typename Scalar, typename Tyre>
FourWheelState<Scalar> FourWheelModel<Scalar, Tyre>::steady_start(const Scalar& speed) const {
  State state = State::Constant(Scalar(0.0));
  state(kU) = speed;
  if (options_.longitudinal) {
    for (Eigen::Index i = 0; i < 4; ++i) state(kWheelSpin + i) = speed / options_.longitudinal->wheel_radius;
  }
  return state;
}

template <typename Scalar, typename Tyre>
WheelControls<Scalar> FourWheelModel<Scalar, Tyre>::wheel_controls(const Scalar& steer, double drive_torque,
                                                                   double brake_torque) const {
  using std::atan;
  using std::cos;
  using std::sin;
  using std::tan;
  WheelControls<Scalar> out;
  out.steer = {steer, steer};
  if (options_.ackermann != 0.0) {
    // The wheel's axis through the turning centre, which lies L/tan(steer) to the left of the rear axle's middle.
    const Scalar slope = tan(steer), across = p_.track_f / (2.0 * p_.wheelbase()) * slope;
    out.steer[0] += options_.ackermann * (atan(slope / (1.0 - across)) - steer);
    out.steer[1] += options_.ackermann * (atan(slope / (1.0 + across)) - steer);
  }
  out.cos = {Scalar(1.0), Scalar(1.0)};
  out.sin = {Scalar(0.0), Scalar(0.0)};
  if (options_.geometry == BicycleGeometry::kExact) {
    out.cos[0] = cos(out.steer[0]);
    out.sin[0] = sin(out.steer[0]);
    out.cos[1] = options_.ackermann == 0.0 ? out.cos[0] : Scalar(cos(out.steer[1]));
    out.sin[1] = options_.ackermann == 0.0 ? out.sin[0] : Scalar(sin(out.steer[1]));
  }
  if (options_.longitudinal) {
    const LongitudinalParameters& l = *options_.longitudinal;
    out.drive = {0.5 * l.front_drive_share * drive_torque, 0.5 * (1.0 - l.front_drive_share) * drive_torque};
    out.brake = {0.5 * l.front_brake_share * brake_torque, 0.5 * (1.0 - l.front_brake_share) * brake_torque};
  }
  return out;
}

template <typename Scalar, typename Tyre>
Scalar FourWheelModel<Scalar, Tyre>::spin_friction(std::size_t wheel, const WheelControls<Scalar>& controls,
                                                   const Scalar& load) const {
  const LongitudinalParameters& l = *options_.longitudinal;
  return controls.brake[is_front(wheel) ? 0 : 1] + l.rolling_resistance * l.wheel_radius * load;
}

template <typename Scalar, typename Tyre>
void FourWheelModel<Scalar, Tyre>::rates(const State& s, const WheelControls<Scalar>& controls,
                                         const PerWheel<double>& road, FourWheelRates<Scalar>& out) const {
  using std::abs;
  using std::atan;
  using std::cos;
  using std::sin;
  using std::sqrt;
  const bool ours = options_.convention == FourWheelConvention::kFirstPrinciples;
  const bool exact = options_.geometry == BicycleGeometry::kExact;
  const bool spins = options_.longitudinal.has_value();
  const bool lags = options_.relaxation_length > 0.0;
  const Scalar &u = s(kU), &v = s(kV), &r = s(kR);
  const Scalar &roll = s(kRoll), &pitch = s(kPitch), &roll_rate = s(kRollRate), &pitch_rate = s(kPitchRate);
  State& d = out.derivative;

  // Sums are formed axle by axle, left plus right: so that mirrored motion has exactly mirrored sums.
  std::array<Scalar, 2> lift, lift_left, Y, X, X_left;
  const Scalar body = s(kHeave) + 0.5 * second_order_ * (roll * roll + pitch * pitch);
  const Scalar body_rate = s(kHeaveRate) + second_order_ * (roll * roll_rate + pitch * pitch_rate);
  const Scalar u_contact = u - contact_arm_ * pitch_rate;
  const Scalar v_contact = v + contact_arm_ * roll_rate;
  for (std::size_t axle = 0; axle < 2; ++axle) {
    const Axle& k = axles_[axle];
    const std::size_t left = 2 * axle, right = left + 1;
    const auto l = static_cast<Eigen::Index>(left), rgt = static_cast<Eigen::Index>(right);

    // Suspension and tyre, as deviations from rest.
    const Scalar middle = body - k.arm * pitch, middle_rate = body_rate - k.arm * pitch_rate;
    const Scalar tilt = k.half * roll, tilt_rate = k.half * roll_rate;
    const Scalar travel_l = s(kWheelHeight + l) - (middle + tilt);
    const Scalar travel_r = s(kWheelHeight + rgt) - (middle - tilt);
    const Scalar bar = k.bar * (travel_l - travel_r);
    const Scalar force_l = k.spring * travel_l + k.damper * (s(kWheelHeightRate + l) - (middle_rate + tilt_rate)) + bar;
    const Scalar force_r =
        k.spring * travel_r + k.damper * (s(kWheelHeightRate + rgt) - (middle_rate - tilt_rate)) - bar;
    Scalar normal_l = k.tyre * (road[left] - s(kWheelHeight + l));
    Scalar normal_r = k.tyre * (road[right] - s(kWheelHeight + rgt));
    out.Fz[left] = k.rest + normal_l;
    out.Fz[right] = k.rest + normal_r;
    if (!(out.Fz[left] > 0.0)) {
      out.Fz[left] = Scalar(0.0);
      if (ours) normal_l = -k.rest;
    }
    if (!(out.Fz[right] > 0.0)) {
      out.Fz[right] = Scalar(0.0);
      if (ours) normal_r = -k.rest;
    }
    out.suspension_travel[left] = travel_l;
    out.suspension_travel[right] = travel_r;
    out.suspension_force[left] = force_l;
    out.suspension_force[right] = force_r;
    lift[axle] = force_l + force_r;
    lift_left[axle] = force_l - force_r;
    d(kWheelHeight + l) = s(kWheelHeightRate + l);
    d(kWheelHeight + rgt) = s(kWheelHeightRate + rgt);
    d(kWheelHeightRate + l) = (normal_l - force_l) * per_unsprung_mass_;
    d(kWheelHeightRate + rgt) = (normal_r - force_r) * per_unsprung_mass_;

    // Slips and tyre forces.
    const Scalar V_y = v_contact + k.x * r;
    std::array<Scalar, 2> force_x, force_y;
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t wheel = left + side;
      const auto w = static_cast<Eigen::Index>(wheel);
      const Scalar V_x = side == 0 ? Scalar(u_contact - k.half * r) : Scalar(u_contact + k.half * r);
      out.contact_x[wheel] = V_x;
      out.contact_y[wheel] = V_y;
      const bool turned = axle == 0 && exact;
      const Scalar along = turned ? Scalar(controls.cos[side] * V_x + controls.sin[side] * V_y) : V_x;
      const Scalar speed = along < 0.0 ? Scalar(-along) : along;
      Scalar slip;
      if (exact) {
        const Scalar across = turned ? Scalar(controls.cos[side] * V_y - controls.sin[side] * V_x) : V_y;
        slip = -atan(across / (speed > kLeastSpeedOfAngle ? speed : Scalar(kLeastSpeedOfAngle)));
      } else {
        slip = (axle == 0 ? controls.steer[side] : Scalar(0.0)) - V_y / V_x;
      }
      d(kLaggedSlip + w) = Scalar(0.0);
      if (lags) {
        d(kLaggedSlip + w) = (slip - s(kLaggedSlip + w)) * speed / options_.relaxation_length;
        slip = s(kLaggedSlip + w);
      }
      Scalar ratio(0.0);
      if (spins) {
        const double radius = options_.longitudinal->wheel_radius;
        ratio =
            (radius * s(kWheelSpin + w) - along) / (speed > kLeastSpeedOfRatio ? speed : Scalar(kLeastSpeedOfRatio));
      }
      const TyreForces<Scalar> f =
          tyres_[wheel].forces(out.Fz[wheel], ratio, slip, Scalar(options_.camber_per_roll * roll));
      out.slip_angle[wheel] = slip;
      out.slip_ratio[wheel] = ratio;
      out.Fx[wheel] = f.Fx;
      out.Fy[wheel] = f.Fy;
      force_x[side] = turned ? Scalar(controls.cos[side] * f.Fx - controls.sin[side] * f.Fy) : f.Fx;
      force_y[side] = turned ? Scalar(controls.sin[side] * f.Fx + controls.cos[side] * f.Fy) : f.Fy;

      d(kWheelSpin + w) = Scalar(0.0);
      if (spins) {
        const LongitudinalParameters& p = *options_.longitudinal;
        const Scalar turning = controls.drive[axle] - p.wheel_radius * f.Fx;
        const Scalar friction = spin_friction(wheel, controls, out.Fz[wheel]);
        const Scalar& spin = s(kWheelSpin + w);
        // Coulomb friction: against the spin, and at rest as much as it takes to stay there.
        const bool forwards = spin > 0.0 || (!(spin < 0.0) && turning > friction);
        const bool backwards = spin < 0.0 || (!(spin > 0.0) && turning < -friction);
        if (forwards) d(kWheelSpin + w) = (turning - friction) / p.wheel_inertia;
        if (backwards) d(kWheelSpin + w) = (turning + friction) / p.wheel_inertia;
      }
    }
    X[axle] = force_x[0] + force_x[1];
    X_left[axle] = force_x[0] - force_x[1];
    Y[axle] = force_y[0] + force_y[1];
  }

  // The body in the plane.
  const Scalar sum_X = X[0] + X[1];
  out.lateral_acceleration = (Y[0] + Y[1]) * per_mass_;
  Scalar pitching_force = sum_X;
  if (spins) {
    const LongitudinalParameters& p = *options_.longitudinal;
    const Scalar drag = 0.5 * p.air_density * p.drag_area * u * (u < 0.0 ? Scalar(-u) : u);
    out.longitudinal_acceleration = (sum_X - drag) * per_mass_ - gravity_along_;
    out.holding_force = Scalar(0.0);
    d(kU) = out.longitudinal_acceleration + r * v;
  } else {
    out.longitudinal_acceleration = -(r * v);
    out.holding_force = p_.mass * out.longitudinal_acceleration - sum_X;
    d(kU) = Scalar(0.0);
    if (ours) pitching_force = p_.mass * out.longitudinal_acceleration;
  }
  d(kV) = out.lateral_acceleration - r * u;
  d(kR) =
      (axles_[0].x * Y[0] + axles_[1].x * Y[1] - (axles_[0].half * X_left[0] + axles_[1].half * X_left[1])) * per_I_z_;
  const Scalar c_yaw = cos(s(kYaw)), s_yaw = sin(s(kYaw));
  d(kX) = u * c_yaw - v * s_yaw;
  d(kY) = u * s_yaw + v * c_yaw;
  d(kYaw) = r;
  d(kDistance) = sqrt(u * u + v * v);

  // The body on its springs; the static corner forces add up to m_s g and have no moment but that of tilting.
  const Scalar sum_lift = lift[0] + lift[1];
  const Scalar tilting = tilting_ + second_order_ * sum_lift;
  d(kHeave) = s(kHeaveRate);
  d(kRoll) = roll_rate;
  d(kPitch) = pitch_rate;
  d(kHeaveRate) = sum_lift * per_heaving_mass_;
  d(kRollRate) =
      (axles_[0].half * lift_left[0] + axles_[1].half * lift_left[1] + tilting * roll + p_.cg_height * (Y[0] + Y[1])) *
      per_I_x_;
  d(kPitchRate) =
      (tilting * pitch - (axles_[0].arm * lift[0] + axles_[1].arm * lift[1]) - p_.cg_height * pitching_force) *
      per_I_y_;
}

}  // namespace veridyn::vehicle
