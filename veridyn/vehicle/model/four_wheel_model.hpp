#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/trigonometry.hpp"
#include "veridyn/vehicle/model/compliance_steer.hpp"
#include "veridyn/vehicle/model/driver.hpp"
#include "veridyn/vehicle/model/four_wheel_options.hpp"
#include "veridyn/vehicle/model/four_wheel_state.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/model/wheel_guidance.hpp"
#include "veridyn/vehicle/model/wheel_steering.hpp"
#include "veridyn/vehicle/tyre/aligning_moments.hpp"
#include "veridyn/vehicle/tyre/four_tyres.hpp"
#include "veridyn/vehicle/tyre/tyre.hpp"
#include "veridyn/vehicle/tyre/tyre_laws.hpp"
#include "veridyn/vehicle/tyre/wheel_arrays.hpp"
#include "veridyn/vehicle/tyre/wheels.hpp"

namespace veridyn::vehicle {

/// The four-wheel model: the body in the plane (x, y, yaw) and in heave, roll and pitch, and four unsprung masses that
/// move up and down between suspension and tyre. Its derivation is in docs/vehicle.md, "Four-wheel model".
///
/// Our convention (`FourWheelConvention::kFirstPrinciples`)
/// - `mass` is the whole vehicle: lateral, longitudinal and yaw motion use it, and I_z. The sprung mass
///   m_s = m - 4 M_w moves in heave, with I_x and I_y about its centre of gravity. All mass is at one height c.
///   The wheels' masses sit at the axles, so the sprung centre of gravity is x_s = 2 M_w (b - a)/m_s ahead of the
///   whole one: the arms x_i of the corner heights count from there. Static tyre loads are m g b/(2 L), m g a/(2 L).
/// - Exact planar motion, small roll and pitch. Height of a corner to second order, less its rest,
///       z_i = z + y_i roll - x_i pitch + c/2 (roll^2 + pitch^2)
///   and all generalised forces by virtual work from it: gravity's tilting moment m_s g c roll comes from the static
///   corner loads. No gyroscopic terms (of order r roll'): good up to about 15 deg of roll and pitch.
/// - Suspension: F_i = static + K_s (z_w - z_i) + C_s (z_w' - z_i') + K_b (travel_i - travel_opposite), both ways.
/// - Tyre: F_z = max(0, static + K_t (z_road - z_w)): it cannot pull.
/// - Tyre forces act at the road: contact velocities V_x = u - y_i r - c pitch', V_y = v + x_i r + c roll' make slips,
///   and the same arms make moments: the power of the tyres is force times contact velocity.
/// - At constant speed the force that holds u acts at the road too and pitches the body.
/// - Where the options ask for it: roll centres, steer by roll, travel and lateral force, springs by table
///   (`WheelGuidance`), lift by the air, and the tyres' aligning moments in the yaw balance.
///
/// Left and right are treated equally to the last bit: mirrored steering, road and state give mirrored rates.
/// `tyres[i]` serves wheel i (side-dependent tyres come in mirrored copies). Usable with double and ceres::Jet; the
/// functions do not allocate.
template <typename Scalar, typename Tyre>
class FourWheelModel {
 public:
  using State = FourWheelState<Scalar>;

  /// Throws InputError("vehicle", ...) on inadmissible options, on wheels that would give way to their tyres as fast as
  /// these push, and on aligning moments of tyres that have none; `parameters` must be admissible.
  FourWheelModel(const VehicleParameters<Scalar>& parameters, const PerWheel<Tyre>& tyres,
                 const FourWheelOptions& options = {});

  /// Upright and at rest in its springs (in the lift of the air, too) at the origin, driving straight ahead at `speed`,
  /// wheels rolling freely.
  [[nodiscard]] State steady_start(const Scalar& speed) const;

  /// Steer angles and torques of the wheels.
  [[nodiscard]] WheelControls<Scalar> wheel_controls(const Scalar& steer, double drive_torque = 0.0,
                                                     double brake_torque = 0.0) const {
    return controls_at_wheels(p_, options_, steer, drive_torque, brake_torque);
  }
  [[nodiscard]] WheelControls<Scalar> wheel_controls(const Controls& controls) const {
    return wheel_controls(Scalar(controls.steer), controls.drive_torque, controls.brake_torque);
  }

  /// Derivative and forces at `state` over a road of the heights `road` under the wheels. (Its definition is flattened:
  /// compilers give up inlining small array operations where many tyres are compiled at once, which halves the speed.)
  void rates(const State& state, const WheelControls<Scalar>& controls, const PerWheel<double>& road,
             FourWheelRates<Scalar>& out) const;

  /// The same with other slips than those of steady rolling, near standstill: `change(out)` gets contact velocities and
  /// steady slips in `out` and may set `slip_angle` and `slip_ratio`, at which the tyres then work.
  template <typename ChangeSlips>
  void rates_at_slips(const State& state, const WheelControls<Scalar>& controls, const PerWheel<double>& road,
                      const ChangeSlips& change, FourWheelRates<Scalar>& out) const;

  /// What a road that is inclined and bends makes felt in its axes, beyond gravity square to a level one: a further
  /// acceleration of every mass, forward, left, up [m/s^2], and how the axes' own roll and pitch rate change [rad/s^2].
  /// The longitudinal and lateral acceleration of the rates contain the former. Without longitudinal dynamics u stays
  /// as it is.
  void set_field(const Eigen::Vector3d& field, const Eigen::Vector2d& turning) {
    field_ = field;
    turning_ = turning;
    in_field_ = !field.isZero(0.0) || !turning.isZero(0.0);
  }
  [[nodiscard]] const Eigen::Vector3d& field() const { return field_; }

  /// Position of the wheels from the vehicle's centre of gravity, x forward, y left [m].
  [[nodiscard]] const WheelArray<Scalar>& wheel_x() const { return x_; }
  [[nodiscard]] const WheelArray<Scalar>& wheel_y() const { return y_; }

  [[nodiscard]] const VehicleParameters<Scalar>& parameters() const { return p_; }
  [[nodiscard]] const PerWheel<Tyre>& tyres() const { return tyres_.tyres(); }
  [[nodiscard]] const FourWheelOptions& options() const { return options_; }
  /// Static loads of the tyres [N], on the grade where there is one.
  [[nodiscard]] const WheelArray<Scalar>& rest_loads() const { return rest_; }

 private:
  using Wheels = WheelArray<Scalar>;
  /// What the rates are made of: how the tyres slip, what pushes up, and what the tyres do in the plane.
  struct Slips {
    Wheels angle, ratio;
  };
  struct VerticalForces {
    Wheels lift;         ///< of the suspension on the body, less its share at rest [N]
    Wheels load;         ///< of the tyres [N]
    Wheels travel_rate;  ///< [m/s]
  };
  struct PlaneForces {
    Wheels Fx;          ///< in wheel axes [N]
    Wheels X, Y;        ///< in vehicle axes [N]
    Scalar turns{0.0};  ///< their moments of their own about the vertical [N m]
  };
  /// Each also fills what it knows of `out`.
  void slips(const State& s, const WheelControls<Scalar>& controls, const Wheels& travel_rate,
             FourWheelRates<Scalar>& out) const;
  VerticalForces vertical_forces(const State& s, const PerWheel<double>& road, FourWheelRates<Scalar>& out) const;
  PlaneForces plane_forces(const Slips& slips, const Wheels& load, const Scalar& camber,
                           const WheelControls<Scalar>& controls, FourWheelRates<Scalar>& out) const;
  /// Forces of wheels that give way to them: turns `controls`, and the slip follows, at once or lagging.
  [[gnu::noinline]] void yield(const Slips& slips, const Wheels& load, const Scalar& camber,
                               WheelControls<Scalar>& controls, Wheels& Fx, Wheels& Fy,
                               FourWheelRates<Scalar>& out) const;
  /// Rates of the body from what the suspension and the tyres do.
  void body_rates(const State& s, const Wheels& lift, const PlaneForces& plane, FourWheelRates<Scalar>& out) const;
  /// What the air lifts at the axles [N].
  [[nodiscard]] std::array<Scalar, 2> air_lift(const Scalar& speed) const;
  /// Heave, pitch and wheels at rest in it.
  void rest_in_air(State& state) const;
  /// Rates of the wheels' spins from what turns them.
  void spin_up(const State& s, const WheelControls<Scalar>& controls, const Wheels& Fx, const Wheels& load,
               FourWheelRates<Scalar>& out) const;

  VehicleParameters<Scalar> p_;
  FourTyres<Tyre> tyres_;
  FourWheelOptions options_;
  WheelGuidance<Scalar> guidance_;
  // What does not change, worked out once. In the source's convention `tilting_` and `contact_height_` are 0.
  WheelArray<Scalar> x_, y_;                          ///< places of the wheels [m]
  WheelArray<Scalar> arm_;                            ///< x from the sprung mass's centre of gravity [m]
  WheelArray<Scalar> spring_, damper_, tyre_, rest_;  ///< stiffness and damping of each corner, static tyre load
  std::array<Scalar, 2> bar_{};                       ///< front and rear [N/m]
  Scalar tilting_{0.0};                               ///< m_s g c [N m/rad]
  Scalar contact_height_{0.0};                        ///< c [m]
  Scalar per_mass_{0.0}, per_heaving_mass_{0.0}, per_unsprung_mass_{0.0};
  Scalar per_I_x_{0.0}, per_I_y_{0.0}, per_I_z_{0.0};
  double gravity_along_ = 0.0;  ///< down the grade [m/s^2]
  Eigen::Vector3d field_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d turning_ = Eigen::Vector2d::Zero();
  bool in_field_ = false;
};

template <typename Scalar, typename Tyre>
FourWheelModel<Scalar, Tyre>::FourWheelModel(const VehicleParameters<Scalar>& parameters, const PerWheel<Tyre>& tyres,
                                             const FourWheelOptions& options)
    : p_(parameters), tyres_(tyres), options_(options) {
  options.validate();
  const bool ours = options.convention == FourWheelConvention::kFirstPrinciples;
  const double grade = options.longitudinal ? options.longitudinal->grade : 0.0;
  const double gravity = options.gravity * std::cos(grade);  // square to the road
  gravity_along_ = options.gravity * std::sin(grade);
  const PerWheel<Scalar> loads = static_loads(p_, gravity);
  const Scalar sprung = p_.mass - 4.0 * p_.unsprung_mass;
  const Scalar x_s = ours ? Scalar(2.0 * p_.unsprung_mass * (p_.b - p_.a) / sprung) : Scalar(0.0);
  for (std::size_t i = 0; i < kWheels; ++i) {
    const bool front = is_front(i);
    const Scalar half = 0.5 * (front ? p_.track_f : p_.track_r);
    x_[i] = front ? p_.a : Scalar(-p_.b);
    y_[i] = is_left(i) ? half : Scalar(-half);
    arm_[i] = x_[i] - x_s;
    spring_[i] = front ? p_.K_sf : p_.K_sr;
    damper_[i] = front ? p_.C_sf : p_.C_sr;
    tyre_[i] = front ? p_.K_tf : p_.K_tr;
    rest_[i] = loads[i];
  }
  bar_ = {p_.K_bf, p_.K_br};
  tilting_ = ours ? Scalar(sprung * gravity * p_.cg_height) : Scalar(0.0);
  contact_height_ = ours ? p_.cg_height : Scalar(0.0);
  per_mass_ = 1.0 / p_.mass;
  per_heaving_mass_ = 1.0 / (ours ? sprung : p_.mass);
  per_unsprung_mass_ = 1.0 / p_.unsprung_mass;
  per_I_x_ = 1.0 / p_.I_x;
  per_I_y_ = 1.0 / p_.I_y;
  per_I_z_ = 1.0 / p_.I_z;
  Wheels stiffness;
  for (std::size_t i = 0; i < kWheels; ++i) {
    stiffness[i] = tyres[i].cornering_stiffness(rest_[i]);
  }
  guidance_ = WheelGuidance<Scalar>(p_, options.suspension_f, options.suspension_r, stiffness,
                                    rest_ - Scalar(p_.unsprung_mass * gravity));
  if (options.aligning_moment && !HasAligningMoment<Tyre, Scalar>)
    throw InputError("vehicle", "aligning_moment needs a tyre that has one");
}

template <typename Scalar, typename Tyre>
FourWheelState<Scalar> FourWheelModel<Scalar, Tyre>::steady_start(const Scalar& speed) const {
  State state = State::Constant(Scalar(0.0));
  state(kU) = speed;
  if (options_.longitudinal) {
    for (Eigen::Index i = 0; i < 4; ++i) state(kWheelSpin + i) = speed / options_.longitudinal->wheel_radius;
  }
  if (options_.lift.acts()) rest_in_air(state);
  return state;
}

template <typename Scalar, typename Tyre>
void FourWheelModel<Scalar, Tyre>::rest_in_air(State& state) const {
  // Both axles carry less by what the air lifts. Gravity tilts the pitching body on, which moves some of that between
  // the axles: a few hundredths of what the springs resist, so that the iteration converges.
  const std::array<Scalar, 2> air = air_lift(state(kU));
  const std::array<Scalar, 2> arm{arm_[0], arm_[2]};
  const Scalar length = arm[0] - arm[1];
  const Scalar tilting = tilting_ - contact_height_ * (air[0] + air[1]);
  std::array<Scalar, 2> height{}, corner{};
  Scalar pitch(0.0);
  for (int round = 0; round < 30; ++round) {
    for (std::size_t axle = 0; axle < 2; ++axle) {
      const auto left = static_cast<Eigen::Index>(2 * axle);
      const Scalar moved = (axle == 0 ? 1.0 : -1.0) * tilting * pitch / length;
      const Scalar spring = 0.5 * (moved - air[axle]);
      height[axle] = -spring / tyre_[left];
      corner[axle] = height[axle] - guidance_.travel_at(left, spring_[left], spring);
    }
    pitch = (corner[1] - corner[0]) / length;
  }
  state(kPitch) = pitch;
  state(kHeave) = corner[0] + arm[0] * pitch - 0.5 * contact_height_ * pitch * pitch;
  for (Eigen::Index i = 0; i < 4; ++i) state(kWheelHeight + i) = height[i < 2 ? 0 : 1];
}

template <typename Scalar, typename Tyre>
std::array<Scalar, 2> FourWheelModel<Scalar, Tyre>::air_lift(const Scalar& speed) const {
  const Scalar pressure = 0.5 * options_.lift.air_density * speed * speed;
  return {options_.lift.area_f * pressure, options_.lift.area_r * pressure};
}

template <typename Scalar, typename Tyre>
void FourWheelModel<Scalar, Tyre>::slips(const State& s, const WheelControls<Scalar>& controls,
                                         const Wheels& travel_rate, FourWheelRates<Scalar>& out) const {
  // The velocity of the contact points in vehicle axes, then in wheel axes.
  const Wheels contact_x = (s(kU) - contact_height_ * s(kPitchRate)) - s(kR) * y_;
  Wheels contact_y = (s(kV) + contact_height_ * s(kRollRate)) + s(kR) * x_;
  if (guidance_.has_roll_centres()) contact_y += guidance_.scrub() * travel_rate;
  out.contact_x = contact_x;
  out.contact_y = contact_y;
  const Wheels along = controls.cos * contact_x + controls.sin * contact_y;
  const Wheels speed = along.abs().max(Scalar(kLeastSpeedOfAngle));
  Wheels slip_angle, slip_ratio, lag;
  if (options_.geometry == BicycleGeometry::kExact) {
    const Wheels across = controls.cos * contact_y - controls.sin * contact_x;
    slip_angle = -numerics::arc_tangents<Scalar>(across / speed);
  } else {
    slip_angle = controls.steer - contact_y / contact_x;
  }
  lag.setConstant(Scalar(0.0));
  if (options_.relaxation_length > 0.0) {
    const Wheels lagged = s.template segment<4>(kLaggedSlip).array();
    lag = (slip_angle - lagged) * speed / Scalar(options_.relaxation_length);
    slip_angle = lagged;
  }
  slip_ratio.setConstant(Scalar(0.0));
  if (options_.longitudinal) {
    const Wheels spin = s.template segment<4>(kWheelSpin).array();
    slip_ratio = (Scalar(options_.longitudinal->wheel_radius) * spin - along) / speed.max(Scalar(kLeastSpeedOfRatio));
  }
  out.slip_angle = slip_angle;
  out.slip_ratio = slip_ratio;
  out.derivative.template segment<4>(kLaggedSlip) = lag.matrix();
}

template <typename Scalar, typename Tyre>
auto FourWheelModel<Scalar, Tyre>::vertical_forces(const State& s, const PerWheel<double>& road,
                                                   FourWheelRates<Scalar>& out) const -> VerticalForces {
  // As deviations from rest.
  const Scalar roll = s(kRoll), pitch = s(kPitch), roll_rate = s(kRollRate), pitch_rate = s(kPitchRate);
  const Wheels height = s.template segment<4>(kWheelHeight).array();
  const Wheels height_rate = s.template segment<4>(kWheelHeightRate).array();
  const Scalar body = s(kHeave) + 0.5 * contact_height_ * (roll * roll + pitch * pitch);
  const Scalar body_rate = s(kHeaveRate) + contact_height_ * (roll * roll_rate + pitch * pitch_rate);
  Wheels travel = height - ((body - pitch * arm_) + roll * y_);
  Wheels travel_rate = height_rate - ((body_rate - pitch_rate * arm_) + roll_rate * y_);
  if (guidance_.has_roll_centres()) {
    // The body rolls about these, not about the ground: so much less a corner rises to second order.
    travel += (0.5 * roll * roll) * guidance_.roll_centre();
    travel_rate += (roll * roll_rate) * guidance_.roll_centre();
  }
  const Scalar bar_f = bar_[0] * (travel[0] - travel[1]), bar_r = bar_[1] * (travel[2] - travel[3]);
  const Wheels bars(bar_f, -bar_f, bar_r, -bar_r);
  Wheels springs = spring_ * travel;
  if (guidance_.has_curves()) guidance_.replace_springs(travel, springs);
  const Wheels lift = springs + damper_ * travel_rate + bars;
  const Wheels ground{{Scalar(road[0]), Scalar(road[1]), Scalar(road[2]), Scalar(road[3])}};
  Wheels normal = tyre_ * (ground - height);
  if (options_.convention == FourWheelConvention::kFirstPrinciples) normal = normal.max(-rest_);
  const Wheels load = (rest_ + normal).max(Scalar(0.0));
  out.suspension_travel = travel;
  out.suspension_force = lift;
  out.Fz = load;
  out.derivative.template segment<4>(kWheelHeight) = height_rate.matrix();
  out.derivative.template segment<4>(kWheelHeightRate) = ((normal - lift) * per_unsprung_mass_).matrix();
  return {lift, load, travel_rate};
}

template <typename Scalar, typename Tyre>
auto FourWheelModel<Scalar, Tyre>::plane_forces(const Slips& slips, const Wheels& load, const Scalar& camber,
                                                const WheelControls<Scalar>& controls,
                                                FourWheelRates<Scalar>& out) const -> PlaneForces {
  Wheels Fx, Fy;
  WheelControls<Scalar> yielded;
  const WheelControls<Scalar>* wheels = &controls;
  if (guidance_.yields()) {
    yielded = controls;
    wheels = &yielded;
    yield(slips, load, camber, yielded, Fx, Fy, out);
  } else {
    tyres_.forces(load, slips.ratio, slips.angle, camber, Fx, Fy);
  }
  out.Fx = Fx;
  out.Fy = Fy;
  PlaneForces plane{Fx, wheels->cos * Fx - wheels->sin * Fy, wheels->sin * Fx + wheels->cos * Fy};
  if (options_.aligning_moment) {
    out.aligning_moment = aligning_moments(tyres_.tyres(), load, slips.ratio, out.slip_angle, camber);
    plane.turns = sum_of_wheels<Scalar>(out.aligning_moment);
  }
  return plane;
}

template <typename Scalar, typename Tyre>
void FourWheelModel<Scalar, Tyre>::yield(const Slips& slips, const Wheels& load, const Scalar& camber,
                                         WheelControls<Scalar>& controls, Wheels& Fx, Wheels& Fy,
                                         FourWheelRates<Scalar>& out) const {
  // Turned by x, a wheel has its slip angle larger by x where it rolls forward, smaller where backward.
  const Wheels along = controls.cos * out.contact_x + controls.sin * out.contact_y;
  Wheels forward;
  for (Eigen::Index i = 0; i < 4; ++i) forward[i] = Scalar(along[i] < 0.0 ? -1.0 : 1.0);
  Wheels steer;
  if (options_.relaxation_length > 0.0) {
    // The force is that of the lagging slip, which moves towards the larger one.
    tyres_.forces(load, slips.ratio, slips.angle, camber, Fx, Fy);
    steer = guidance_.compliance() * Fy;
    const Wheels rate = along.abs().max(Scalar(kLeastSpeedOfAngle)) / Scalar(options_.relaxation_length);
    out.derivative.template segment<4>(kLaggedSlip) += (forward * steer * rate).matrix();
  } else {
    const auto force_at = [&](const Wheels& turned, Wheels& force) {
      tyres_.forces(load, slips.ratio, Wheels(slips.angle + forward * turned), camber, Fx, Fy);
      force = Fy;
    };
    steer = compliance_steer<Scalar>(guidance_.compliance(), Wheels(forward * guidance_.yielding()), force_at);
    out.slip_angle = slips.angle + forward * steer;
  }
  out.suspension_steer += steer;
  controls.turn(steer, options_.geometry == BicycleGeometry::kExact);
}

template <typename Scalar, typename Tyre>
void FourWheelModel<Scalar, Tyre>::spin_up(const State& s, const WheelControls<Scalar>& controls, const Wheels& Fx,
                                           const Wheels& load, FourWheelRates<Scalar>& out) const {
  auto rate = out.derivative.template segment<4>(kWheelSpin);
  rate.setConstant(Scalar(0.0));
  if (!options_.longitudinal) return;
  const LongitudinalParameters& l = *options_.longitudinal;
  const Wheels spin = s.template segment<4>(kWheelSpin).array();
  for (Eigen::Index i = 0; i < 4; ++i) {
    // Coulomb friction: against the spin, and at rest as much as it takes to stay there.
    const Scalar turning = controls.drive[i] - l.wheel_radius * Fx[i];
    const Scalar friction = controls.brake[i] + l.rolling_resistance * l.wheel_radius * load[i];
    const bool rests = !(spin[i] > 0.0) && !(spin[i] < 0.0);
    if (spin[i] > 0.0 || (rests && turning > friction)) rate[i] = (turning - friction) / l.wheel_inertia;
    if (spin[i] < 0.0 || (rests && turning < -friction)) rate[i] = (turning + friction) / l.wheel_inertia;
  }
}

template <typename Scalar, typename Tyre>
[[gnu::flatten]] void FourWheelModel<Scalar, Tyre>::rates(const State& s, const WheelControls<Scalar>& controls,
                                                          const PerWheel<double>& road,
                                                          FourWheelRates<Scalar>& out) const {
  rates_at_slips(
      s, controls, road, [](const FourWheelRates<Scalar>& /*steady*/) {}, out);
}

template <typename Scalar, typename Tyre>
template <typename ChangeSlips>
[[gnu::flatten]] void FourWheelModel<Scalar, Tyre>::rates_at_slips(const State& s,
                                                                   const WheelControls<Scalar>& controls,
                                                                   const PerWheel<double>& road,
                                                                   const ChangeSlips& change,
                                                                   FourWheelRates<Scalar>& out) const {
  const VerticalForces vertical = vertical_forces(s, road, out);
  WheelControls<Scalar> steered;
  const WheelControls<Scalar>* wheels = &controls;
  if (guidance_.steers()) {
    steered = controls;
    wheels = &steered;
    out.suspension_steer = guidance_.steer(out.suspension_travel);
    steered.turn(out.suspension_steer, options_.geometry == BicycleGeometry::kExact);
  } else if (guidance_.yields()) {
    out.suspension_steer.setConstant(Scalar(0.0));
  }
  slips(s, *wheels, vertical.travel_rate, out);
  change(out);
  const Slips slip{out.slip_angle, out.slip_ratio};
  const PlaneForces plane =
      plane_forces(slip, vertical.load, Scalar(options_.camber_per_roll * s(kRoll)), *wheels, out);
  spin_up(s, *wheels, plane.Fx, vertical.load, out);
  if (guidance_.has_roll_centres()) {
    // Links push wheel and body apart where the path of a contact point is not square to its force.
    const Wheels links = guidance_.scrub() * plane.Y;
    out.derivative.template segment<4>(kWheelHeightRate) += (links * per_unsprung_mass_).matrix();
    body_rates(s, vertical.lift - links, plane, out);
  } else {
    body_rates(s, vertical.lift, plane, out);
  }
}

template <typename Scalar, typename Tyre>
[[gnu::flatten]] void FourWheelModel<Scalar, Tyre>::body_rates(const State& s, const Wheels& lift,
                                                               const PlaneForces& plane,
                                                               FourWheelRates<Scalar>& out) const {
  using std::sqrt;
  const bool ours = options_.convention == FourWheelConvention::kFirstPrinciples;
  State& d = out.derivative;
  const Scalar u = s(kU), v = s(kV), r = s(kR), roll = s(kRoll), pitch = s(kPitch);
  const Scalar sum_lift = sum_of_wheels<Scalar>(lift);
  const Scalar lift_rolls = sum_of_wheels<Scalar>(y_ * lift), lift_pitches = sum_of_wheels<Scalar>(arm_ * lift);
  const Scalar sum_X = sum_of_wheels<Scalar>(plane.X), sum_Y = sum_of_wheels<Scalar>(plane.Y);

  // The body in the plane.
  Scalar longitudinal_acceleration, holding_force(0.0), pitching_force = sum_X, u_rate(0.0);
  if (options_.longitudinal) {
    const LongitudinalParameters& l = *options_.longitudinal;
    const Scalar drag = 0.5 * l.air_density * l.drag_area * u * (u < 0.0 ? Scalar(-u) : u);
    longitudinal_acceleration = (sum_X - drag) * per_mass_ - gravity_along_;
    u_rate = longitudinal_acceleration + r * v;
  } else {
    longitudinal_acceleration = -(r * v);
    holding_force = p_.mass * longitudinal_acceleration - sum_X;
    if (ours) pitching_force = p_.mass * longitudinal_acceleration;
  }
  const Scalar lateral_acceleration = sum_Y * per_mass_;
  out.longitudinal_acceleration = longitudinal_acceleration;
  out.lateral_acceleration = lateral_acceleration;
  out.holding_force = holding_force;
  const numerics::SineCosine<Scalar> yaw = numerics::sine_cosine<Scalar>(s(kYaw));

  // The body on its springs; the static corner forces add up to m_s g and have no moment but that of tilting.
  const Scalar tilting = tilting_ + contact_height_ * sum_lift;
  Scalar roll_moment = lift_rolls + tilting * roll + p_.cg_height * sum_Y;
  Scalar pitch_moment = tilting * pitch - lift_pitches - p_.cg_height * pitching_force;
  Scalar heaving_force = sum_lift, yaw_moment = sum_of_wheels<Scalar>(x_ * plane.Y - y_ * plane.X);
  if (guidance_.has_roll_centres())
    roll_moment -= (guidance_.tilting() + sum_of_wheels<Scalar>(guidance_.roll_centre() * lift)) * roll;
  if (options_.lift.acts()) {
    const std::array<Scalar, 2> air = air_lift(u);
    heaving_force += air[0] + air[1];
    pitch_moment -= arm_[0] * air[0] + arm_[2] * air[1];
  }
  if (options_.aligning_moment) yaw_moment += plane.turns;

  d(kX) = u * yaw.cos - v * yaw.sin;
  d(kY) = u * yaw.sin + v * yaw.cos;
  d(kYaw) = r;
  d(kU) = u_rate;
  d(kV) = lateral_acceleration - r * u;
  d(kR) = yaw_moment * per_I_z_;
  d(kHeave) = s(kHeaveRate);
  d(kRoll) = s(kRollRate);
  d(kPitch) = s(kPitchRate);
  d(kHeaveRate) = heaving_force * per_heaving_mass_;
  d(kRollRate) = roll_moment * per_I_x_;
  d(kPitchRate) = pitch_moment * per_I_y_;
  d(kDistance) = sqrt(u * u + v * v);
  if (!in_field_) return;
  if (options_.longitudinal) {
    d(kU) += field_.x();
    out.longitudinal_acceleration += field_.x();
  }
  d(kV) += field_.y();
  out.lateral_acceleration += field_.y();
  d(kRollRate) -= turning_.x();
  d(kPitchRate) -= turning_.y();
  d(kHeaveRate) += field_.z() + turning_.y() * (x_[0] - arm_[0]);
  for (Eigen::Index i = 0; i < 4; ++i)
    d(kWheelHeightRate + i) += field_.z() - turning_.x() * y_[i] + turning_.y() * x_[i];
}

}  // namespace veridyn::vehicle
