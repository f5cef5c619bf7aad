#include "veridyn/vehicle/simulation/stepped_drive.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/model/four_wheel_models.hpp"
#include "veridyn/vehicle/simulation/body_motion.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation_loop.hpp"

namespace veridyn::vehicle {

namespace {

/// Step times rate that is followed well inside the stability of the Runge-Kutta method.
constexpr double kRateOfPart = 1.25;
constexpr double kMostTilt = 45.0 * kDegree;

double contact_speed(const FourWheelRates<double>& rates, Eigen::Index i) {
  return std::hypot(rates.contact_x[i], rates.contact_y[i]);
}

/// Share of steady slip at a contact speed: 0 standing, 1 rolling, with continuous slope.
double share_of_steady(double speed) {
  const double s = std::clamp((speed - kStandingSpeed) / (kRollingSpeed - kStandingSpeed), 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

}  // namespace

template <typename Tyre>
SteppedDrive<Tyre>::SteppedDrive(const Model& model, std::shared_ptr<const Road> road, double usual_speed)
    : model_(model), road_(std::move(road)), spins_(model.options().longitudinal.has_value()) {
  const VehicleParameters<double>& p = model_.parameters();
  internal::check_parameters(p);
  if (!(usual_speed > 0.0 && usual_speed < kInfinity)) throw InputError("drive", "usual speed must be > 0");
  if (spins_ && model_.options().geometry != BicycleGeometry::kExact) {
    throw InputError("vehicle",
                     "geometry is for small angles, whose slip has no value at rest; a stepped drive with "
                     "longitudinal dynamics needs the exact one");
  }
  const internal::FastestRates fastest = internal::fastest_rates(model_, usual_speed);
  internal::check_step(1e-6, fastest.all);
  longest_step_ = 2.5 / fastest.all;
  spins_rate_speed_ = fastest.spins * usual_speed;
  most_ratio_ = most_tangent_ = damping_x_ = damping_y_ = WheelArray<double>::Zero();
  if (spins_) {
    const LongitudinalParameters& l = *model_.options().longitudinal;
    const double lag = model_.options().relaxation_length;
    sigma_ = lag > 0.0 ? lag : l.wheel_radius / 3.0;
    double stiffest_x = 0.0, stiffest_y = 0.0;
    WheelArray<double> along, across;
    for (Eigen::Index i = 0; i < 4; ++i) {
      constexpr double kSmall = 1e-4;
      const Tyre& tyre = model_.tyres()[i];
      const double load = model_.rest_loads()[i];
      along[i] = (tyre.forces(load, kSmall, 0.0, 0.0).Fx - tyre.forces(load, -kSmall, 0.0, 0.0).Fx) / (2.0 * kSmall);
      across[i] = tyre.cornering_stiffness(load);
      stiffest_x = std::max(stiffest_x, along[i]);
      stiffest_y = std::max(stiffest_y, across[i]);
      if (!(along[i] > 0.0 && across[i] > 0.0)) {
        throw InputError("vehicle", "a tyre without stiffness at its static load cannot hold a standing car");
      }
    }
    most_ratio_ = 3.0 * model_.rest_loads() / along;
    most_tangent_ = 3.0 * model_.rest_loads() / across;
    damping_x_.setConstant(std::sqrt(p.mass / (sigma_ * along.sum())));
    damping_y_.setConstant(std::sqrt(p.mass / (sigma_ * across.sum())));
    const double stiffness = std::max(stiffest_x, stiffest_y);
    const double reach = std::max(p.a, p.b), r = l.wheel_radius;
    // What moves a contact patch under a unit force: the body with its yaw and tilt, and the wheel's spin. Four patches
    // at most move it together.
    const double body = 4.0 * (1.0 / p.mass + (reach * reach + 0.25 * p.track_f * p.track_f) / p.I_z +
                               p.cg_height * p.cg_height / std::min(p.I_x, p.I_y));
    const double mobility = body + r * r / l.wheel_inertia;
    standing_rate_ = std::max(std::sqrt(stiffness / sigma_ * mobility),
                              stiffness * mobility * std::max(damping_x_[0], damping_y_[0]));
  }
  reset();
}

template <typename Tyre>
void SteppedDrive<Tyre>::reset(double speed) {
  DriveState start;
  start.vehicle = model_.steady_start(speed);
  reset(start);
}

template <typename Tyre>
void SteppedDrive<Tyre>::reset(const DriveState& state) {
  state_ = state;
  evaluate();
}

template <typename Tyre>
void SteppedDrive<Tyre>::reset(const DriveState& state, const Eigen::Vector3d& field, const Eigen::Vector2d& turning) {
  model_.set_field(field, turning);
  reset(state);
}

template <typename Tyre>
PerWheel<double> SteppedDrive<Tyre>::under(const FourWheelState<double>& state) const {
  return RoadUnderWheels<Model>{model_, road_.get()}(state);
}

template <typename Tyre>
bool SteppedDrive<Tyre>::rolls() const {
  if (!spins_) return true;
  for (Eigen::Index i = 0; i < 4; ++i) {
    if (!(contact_speed(rates_, i) >= kRollingSpeed)) return false;
  }
  return true;
}

template <typename Tyre>
void SteppedDrive<Tyre>::evaluate() noexcept {
  at_wheels_ = model_.wheel_controls(state_.controls);
  model_.rates(state_.vehicle, at_wheels_, under(state_.vehicle), rates_);
  if (rolls()) return;
  Standing unused;
  slow_rates(state_.vehicle, {state_.deflection_x, state_.deflection_y}, rates_, unused);
}

template <typename Tyre>
void SteppedDrive<Tyre>::slow_rates(const FourWheelState<double>& state, const Standing& standing,
                                    FourWheelRates<double>& rates, Standing& change) const {
  const double radius = model_.options().longitudinal->wheel_radius;
  const auto deflected = [&](FourWheelRates<double>& out) {
    for (Eigen::Index i = 0; i < 4; ++i) {
      const double c = at_wheels_.cos[i], s = at_wheels_.sin[i];
      const double along = c * out.contact_x[i] + s * out.contact_y[i];
      const double across = c * out.contact_y[i] - s * out.contact_x[i];
      const double slide = radius * state(kWheelSpin + i) - along;
      const double leak = std::abs(along) / sigma_;
      change.x[i] = slide - leak * standing.x[i];
      change.y[i] = -across - leak * standing.y[i];
      const double steady = share_of_steady(contact_speed(out, i));
      const double ratio = std::clamp(standing.x[i] / sigma_, -most_ratio_[i], most_ratio_[i]) + damping_x_[i] * slide;
      const double tangent =
          std::clamp(standing.y[i] / sigma_, -most_tangent_[i], most_tangent_[i]) - damping_y_[i] * across;
      out.slip_ratio[i] = steady * out.slip_ratio[i] + (1.0 - steady) * ratio;
      out.slip_angle[i] = steady * out.slip_angle[i] + (1.0 - steady) * std::atan(tangent);
    }
  };
  model_.rates_at_slips(state, at_wheels_, under(state), deflected, rates);
}

template <typename Tyre>
void SteppedDrive<Tyre>::slow_step(double h) noexcept {
  // The vehicle's states and, after them, the deflections along and across.
  constexpr int kAlong = kFourWheelStates, kAcross = kAlong + 4, kAll = kAcross + 4;
  using State = Eigen::Matrix<double, kAll, 1>;
  const FourWheelState<double> start = state_.vehicle;
  FourWheelRates<double> rates;
  const auto rates_at = [&](const State& at) {
    Standing change;
    slow_rates(at.template head<kFourWheelStates>(),
               {at.template segment<4>(kAlong).array(), at.template segment<4>(kAcross).array()}, rates, change);
    State out;
    out << rates.derivative, change.x.matrix(), change.y.matrix();
    return out;
  };
  // Friction stops a wheel for one part at least. One that crosses zero in a stage stops too: with friction of both
  // signs in one part it would tremble on.
  std::array<bool, kWheels> stopped{};
  const auto stop = [&](auto& at) {
    for (std::size_t i = 0; i < kWheels; ++i) {
      const auto w = kWheelSpin + static_cast<Eigen::Index>(i);
      stopped[i] = stopped[i] || start(w) * at(w) < 0.0;
      if (stopped[i]) at(w) = 0.0;
    }
  };
  State stage_rate;
  const auto rate = [&](numerics::RungeKuttaMoment, State& at) -> const State& {
    stop(at);
    return stage_rate = rates_at(at);
  };
  State state;
  state << start, state_.deflection_x.matrix(), state_.deflection_y.matrix();
  numerics::runge_kutta_4_in_place<kAll>(rates_at(state), rate, h, state);
  const WheelArray<double> most_x = sigma_ * most_ratio_, most_y = sigma_ * most_tangent_;
  state_.deflection_x = state.template segment<4>(kAlong).array().max(-most_x).min(most_x);
  state_.deflection_y = state.template segment<4>(kAcross).array().max(-most_y).min(most_y);
  state_.vehicle = state.template head<kFourWheelStates>();
  stop(state_.vehicle);
}

template <typename Tyre>
void SteppedDrive<Tyre>::follow_steady_slip() noexcept {
  for (Eigen::Index i = 0; i < 4; ++i) {
    state_.deflection_x[i] = sigma_ * std::clamp(rates_.slip_ratio[i], -most_ratio_[i], most_ratio_[i]);
    const double tangent = std::tan(std::clamp(rates_.slip_angle[i], -1.5, 1.5));
    state_.deflection_y[i] = sigma_ * std::clamp(tangent, -most_tangent_[i], most_tangent_[i]);
  }
}

template <typename Tyre>
void SteppedDrive<Tyre>::part(double h) noexcept {
  const DriveState before = state_;
  FourWheelState<double>& s = state_.vehicle;
  if (rolls()) {
    int parts = 1;
    if (spins_) {
      FourWheelState<double> forward = s;
      forward(kU) = std::abs(s(kU));
      parts = internal::parts_of_step(h * spins_rate_speed_, model_.parameters(), forward);
    }
    std::array<WheelControls<double>, 3> controls{at_wheels_, at_wheels_, at_wheels_};
    const auto heights = [this](const FourWheelState<double>& at) { return under(at); };
    const auto held = [this](double /*time*/) -> const WheelControls<double>& { return at_wheels_; };
    internal::advance(model_, heights, held, state_.time, h, parts, controls, rates_, s);
    if (spins_) follow_steady_slip();
  } else {
    const double fastest = std::max(standing_rate_, spins_rate_speed_ / kLeastSpeedOfRatio);
    const int parts = std::clamp(static_cast<int>(std::ceil(h * fastest / kRateOfPart)), 1, 256);
    for (int i = 0; i < parts; ++i) slow_step(h / parts);
  }
  state_.time = before.time + h;
  hold_limits(before);
  evaluate();
}

template <typename Tyre>
void SteppedDrive<Tyre>::hold_limits(const DriveState& before) noexcept {
  FourWheelState<double>& s = state_.vehicle;
  if (!(std::abs(s.sum() + state_.deflection_x.sum() + state_.deflection_y.sum()) < kInfinity)) {
    // Nothing can be said of such a motion but that it must end: the vehicle stands where it was last known.
    const double time = state_.time;
    state_ = before;
    state_.time = time;
    ++state_.refused;
    for (const Eigen::Index i : {kU, kV, kR, kHeaveRate, kRollRate, kPitchRate}) s(i) = 0.0;
    s.segment<4>(kWheelHeightRate).setZero();
    s.segment<4>(kWheelSpin).setZero();
  }
  state_.rolled_over = false;
  for (const auto& [angle, rate] : {std::pair{kRoll, kRollRate}, std::pair{kPitch, kPitchRate}}) {
    if (!(std::abs(s(angle)) >= kMostTilt)) continue;
    state_.rolled_over = true;
    s(angle) = std::copysign(kMostTilt, s(angle));
    if (s(rate) * s(angle) > 0.0) s(rate) = 0.0;
  }
}

template <typename Tyre>
void SteppedDrive<Tyre>::step(const Controls& controls, double dt) noexcept {
  if (!(dt > 0.0 && dt <= 1.0)) {
    ++state_.refused;
    if (!(dt > 1.0)) return;
    dt = 1.0;
  }
  if (!internal::admissible(controls)) {
    ++state_.refused;
  } else if (controls.steer != state_.controls.steer || controls.drive_torque != state_.controls.drive_torque ||
             controls.brake_torque != state_.controls.brake_torque) {
    state_.controls = controls;
    evaluate();
  }
  const int parts = static_cast<int>(std::ceil(dt / longest_step_));
  const double end = state_.time + dt;
  for (int i = 0; i < parts; ++i) part(dt / parts);
  state_.time = end;
}

template <typename Tyre>
recording::MotionSample SteppedDrive<Tyre>::motion(const Eigen::Vector3d& place) const {
  const FourWheelState<double>& s = state_.vehicle;
  const FourWheelState<double>& d = rates_.derivative;
  const double grade = spins_ ? model_.options().longitudinal->grade : 0.0;
  const Eigen::Vector3d& field = model_.field();
  recording::MotionSample out = motion_sample({.time = state_.time,
                                               .x = s(kX),
                                               .y = s(kY),
                                               .yaw = s(kYaw),
                                               .roll = s(kRoll),
                                               .pitch = s(kPitch),
                                               .yaw_rate = s(kR),
                                               .roll_rate = s(kRollRate),
                                               .pitch_rate = s(kPitchRate),
                                               .yaw_acceleration = d(kR),
                                               .roll_acceleration = d(kRollRate),
                                               .pitch_acceleration = d(kPitchRate),
                                               .forward = rates_.longitudinal_acceleration - (spins_ ? field.x() : 0.0),
                                               .leftward = rates_.lateral_acceleration - field.y(),
                                               .upward = d(kHeaveRate) - field.z(),
                                               .speed = s(kU)},
                                              model_.options().gravity, grade);
  out.inputs = {state_.controls.steer, state_.controls.drive_torque, state_.controls.brake_torque};
  out.steer_from = recording::Origin::kMeasured;
  if (spins_) out.torque_from = recording::Origin::kMeasured;
  return recording::at_place(out, place);
}

// NOLINTNEXTLINE(bugprone-macro-parentheses): the name of a template takes none
#define VERIDYN_STEP_ON(Tyre) template class SteppedDrive<Tyre<double>>;
VERIDYN_TYRE_LAWS(VERIDYN_STEP_ON)
#undef VERIDYN_STEP_ON

}  // namespace veridyn::vehicle
