#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"

/// The definitions behind vehicle_simulation.hpp, for tyres that vehicle_simulation.cpp does not compile.
namespace veridyn::vehicle {

namespace internal {

/// The step below for a model of which only the first `kMoving` states move.
template <int kMoving, typename Scalar, typename Tyre, typename Heights>
void runge_kutta_step(const FourWheelModel<Scalar, Tyre>& model, const Heights& heights,
                      const std::array<WheelControls<Scalar>, 3>& controls, double h,
                      const FourWheelRates<Scalar>& first, FourWheelState<Scalar>& state) {
  FourWheelRates<Scalar> stage;
  const auto rate = [&](numerics::RungeKuttaMoment moment,
                        const FourWheelState<Scalar>& at) -> const FourWheelState<Scalar>& {
    model.rates(at, controls[moment == numerics::RungeKuttaMoment::kMiddle ? 1 : 2], heights(at), stage);
    return stage.derivative;
  };
  numerics::runge_kutta_4_in_place<kMoving>(first.derivative, rate, h, state);
}

}  // namespace internal

/// One step of the classical Runge-Kutta method of order 4 for the four-wheel model. `first` holds the rates at the
/// beginning (from `FourWheelModel::rates`); `heights(state)` gives the road under the wheels; controls at the
/// beginning, middle and end of the step are in `controls`. Usable with Jets; does not allocate.
template <typename Scalar, typename Tyre, typename Heights>
void four_wheel_step(const FourWheelModel<Scalar, Tyre>& model, const Heights& heights,
                     const std::array<WheelControls<Scalar>, 3>& controls, double h,
                     const FourWheelRates<Scalar>& first, FourWheelState<Scalar>& state) {
  if (model.options().longitudinal || model.options().relaxation_length > 0.0) {
    internal::runge_kutta_step<kFourWheelStates>(model, heights, controls, h, first, state);
  } else {
    internal::runge_kutta_step<kWheelSpin>(model, heights, controls, h, first, state);
  }
}

/// View of a model and the road under its four wheels, for the heights there; null: flat. Derivatives do not go through
/// it.
template <typename Model>
struct RoadUnderWheels {
  const Model& model;
  const Road* road;

  [[nodiscard]] PerWheel<double> operator()(const typename Model::State& state) const {
    if (road == nullptr) return {};
    PerWheel<double> heights;
    const auto [s, c] = numerics::sine_cosine<double>(state(kYaw));
    for (std::size_t i = 0; i < kWheels; ++i) {
      const double ahead = model.wheel_x()[i], left = model.wheel_y()[i];
      heights[i] = road->height({.x = state(kX) + (ahead * c - left * s),
                                 .y = state(kY) + (ahead * s + left * c),
                                 .distance = state(kDistance) + ahead,
                                 .offset = left});
    }
    return heights;
  }
};

namespace internal {

/// Throws InputError("drive", ...) when the numbers of a driver are out of range.
void check_controls(const Controls& controls, double time, bool with_torques);
[[nodiscard]] inline bool admissible(const Controls& c) {
  return c.steer > -1.5707963 && c.steer < 1.5707963 && c.brake_torque >= 0.0 && c.brake_torque < kInfinity &&
         std::abs(c.drive_torque) < kInfinity;
}
[[nodiscard]] inline Controls controls_at(const Driver& driver, double time, bool with_torques) {
  const Controls controls = driver.controls(time);
  if (!admissible(controls)) check_controls(controls, time, with_torques);
  return controls;
}

/// Throws InputError("vehicle", ...) on inadmissible parameters.
void check_parameters(const VehicleParameters<double>& parameters);

/// How fast a linear system with this matrix moves: the largest absolute eigenvalue [1/s]; infinite with NaN in it.
[[nodiscard]] double fastest_eigenvalue(const Eigen::MatrixXd& matrix);

/// Throws InputError("drive", ...) when a Runge-Kutta step of this length cannot follow a rate.
void check_step(double step, double fastest);

/// Where steps and samples fall: `steps` steps, the last one possibly shorter, a sample every `per_sample`.
struct StepPlan {
  long steps = 0;
  long per_sample = 1;
  double step = 0.0;
  double duration = 0.0;
  [[nodiscard]] double time(long k) const { return k >= steps ? duration : static_cast<double>(k) * step; }
  [[nodiscard]] bool sampled(long k) const { return k >= steps || k % per_sample == 0; }
  [[nodiscard]] std::size_t samples() const { return static_cast<std::size_t>(steps / per_sample + 2); }
};
[[nodiscard]] StepPlan plan_steps(const SimulationOptions& options);

/// Reports every 1024th step. False: stop.
[[nodiscard]] inline bool report_progress(Progress& progress, long k, const StepPlan& plan) {
  return k % 1024 != 0 || progress.update(static_cast<double>(k) / static_cast<double>(plan.steps));
}

void reserve(VehicleTrajectory& out, std::size_t samples, bool vertical, bool spins);

/// How fast the model's motion is at its start, from differences of its rates [1/s].
struct FastestRates {
  double all = 0.0;    ///< of all states but the wheels' spins
  double spins = 0.0;  ///< of the motion in the plane with the spins; goes with the inverse of the speed
};
template <typename Tyre>
[[nodiscard]] FastestRates fastest_rates(const FourWheelModel<double, Tyre>& model, double speed) {
  using State = FourWheelState<double>;
  const State start = model.steady_start(speed);
  const auto straight = model.wheel_controls(0.0);
  Eigen::MatrixXd all(kFourWheelStates, kFourWheelStates);
  FourWheelRates<double> rates;
  for (Eigen::Index j = 0; j < kFourWheelStates; ++j) {
    const double step = 1e-6 * (j >= kWheelSpin && j < kWheelSpin + 4 ? std::max(1.0, start(j)) : 1.0);
    State at = start;
    at(j) += step;
    model.rates(at, straight, {}, rates);
    all.col(j) = rates.derivative;
    at(j) = start(j) - step;
    model.rates(at, straight, {}, rates);
    all.col(j) = (all.col(j) - rates.derivative) / (2.0 * step);
  }
  const std::array<Eigen::Index, 7> plane{kU, kV, kR, kWheelSpin, kWheelSpin + 1, kWheelSpin + 2, kWheelSpin + 3};
  const Eigen::MatrixXd in_plane = all(plane, plane);
  all.middleRows<4>(kWheelSpin).setZero();
  all.middleCols<4>(kWheelSpin).setZero();
  return {fastest_eigenvalue(all), fastest_eigenvalue(in_plane)};
}

template <typename State>
void record_plane(VehicleTrajectory& out, double time, const State& s, double steer) {
  out.time.push_back(time);
  out.x.push_back(s(kX));
  out.y.push_back(s(kY));
  out.yaw.push_back(s(kYaw));
  out.u.push_back(s(kU));
  out.v.push_back(s(kV));
  out.r.push_back(s(kR));
  out.steer.push_back(steer);
}

void record(VehicleTrajectory& out, double time, const FourWheelState<double>& state, const Controls& controls,
            const FourWheelRates<double>& rates, const PerWheel<double>& road, bool spins);

/// Which wheels are off the ground, since when.
class LiftOffs {
 public:
  void see(double time, const WheelArray<double>& normal_force, std::vector<LiftOff>& found) {
    const bool all_on = normal_force.minCoeff() > 0.0;
    if (!all_on || any_off_) change(time, normal_force, found);
  }
  void end(double time, std::vector<LiftOff>& found) const;

 private:
  void change(double time, const WheelArray<double>& normal_force, std::vector<LiftOff>& found);

  bool any_off_ = false;
  PerWheel<double> since_{-1.0, -1.0, -1.0, -1.0};
};

/// The model from `time` on.
template <typename Model>
void change_model(double time, std::span<const ModelChange<Model>>& changes, Model& model) {
  while (!changes.empty() && time >= changes.front().time - 1e-9) {
    model = changes.front().model;
    changes = changes.subspan(1);
  }
}

/// Into how many equal parts a step is cut. A wheel's spin relaxes the faster the slower it rolls: `rates_speed` is the
/// step times rate times speed at which the rate holds; twice the stiffness at rest is left for load transfer.
[[nodiscard]] inline int parts_of_step(double rates_speed, const VehicleParameters<double>& p,
                                       const FourWheelState<double>& state) {
  const double slowest =
      std::max(kLeastSpeedOfRatio, state(kU) - 0.5 * std::max(p.track_f, p.track_r) * std::abs(state(kR)));
  return std::clamp(static_cast<int>(std::ceil(rates_speed / (1.25 * slowest))), 1, 256);
}

/// The controls of the wheels, worked out again only where the driver's change: mostly they stay as they were, at the
/// latest from the end of a step to the beginning of the next.
template <typename Model>
class LatestControls {
 public:
  explicit LatestControls(const Model& model) : at_wheels_(model.wheel_controls(latest_)) {}
  const WheelControls<double>& of(const Model& model, const Controls& now) {
    if (now.steer != latest_.steer || now.drive_torque != latest_.drive_torque ||
        now.brake_torque != latest_.brake_torque) {
      latest_ = now;
      at_wheels_ = model.wheel_controls(now);
    }
    return at_wheels_;
  }

 private:
  Controls latest_;
  WheelControls<double> at_wheels_;
};

/// From `begin` over `step` in equal parts: the step of every drive, recorded or stepped from outside. `rates` and
/// `controls[0]` are those of the beginning; `controls_at(time)` gives the wheels' within the step.
template <typename Tyre, typename Heights, typename ControlsAt>
void advance(const FourWheelModel<double, Tyre>& model, const Heights& heights, const ControlsAt& controls_at,
             double begin, double step, int parts, std::array<WheelControls<double>, 3>& controls,
             FourWheelRates<double>& rates, FourWheelState<double>& state) {
  const bool spins = model.options().longitudinal.has_value();
  const double h = step / parts;
  for (int part = 0; part < parts; ++part) {
    const double t = begin + part * h;
    if (part > 0) {
      controls[0] = controls[2];
      model.rates(state, controls[0], heights(state), rates);
    }
    controls[1] = controls_at(t + 0.5 * h);
    controls[2] = controls_at(part + 1 == parts ? begin + step : t + h);
    const WheelArray<double> before = state.segment<4>(kWheelSpin).array();
    four_wheel_step(model, heights, controls, h, rates, state);
    if (!spins) continue;
    for (Eigen::Index i = 0; i < 4; ++i) {
      // Friction stops a wheel and never turns it the other way.
      if (before[i] * state(kWheelSpin + i) < 0.0) state(kWheelSpin + i) = 0.0;
    }
  }
}

/// Whether the vehicle's motion ends here, and how; kCompleted: it goes on.
[[nodiscard]] DriveEnd ended(const FourWheelState<double>& state, bool speed_varies);

}  // namespace internal

template <typename Tyre>
VehicleTrajectory simulate(const FourWheelModel<double, Tyre>& start, Driver& driver, const Road* road,
                           const SimulationOptions& options, Progress& progress,
                           std::span<const ModelChange<FourWheelModel<double, Tyre>>> changes) {
  FourWheelModel<double, Tyre> model = start;
  options.validate();
  internal::check_parameters(model.parameters());
  const bool spins = model.options().longitudinal.has_value();
  const internal::FastestRates fastest = internal::fastest_rates(model, options.speed);
  internal::check_step(options.step, fastest.all);
  const internal::StepPlan plan = internal::plan_steps(options);

  VehicleTrajectory out;
  internal::reserve(out, plan.samples(), true, spins);
  const RoadUnderWheels<FourWheelModel<double, Tyre>> heights{model, road};
  FourWheelState<double> state = model.steady_start(options.speed);
  FourWheelRates<double> rates;
  std::array<WheelControls<double>, 3> controls;
  internal::LatestControls latest(model);
  const auto at_wheels = [&](const Controls& now) -> const WheelControls<double>& { return latest.of(model, now); };
  internal::LiftOffs lift_offs;
  progress.stage("driving");
  for (long k = 0;; ++k) {
    const double begin = plan.time(k);
    internal::change_model(begin, changes, model);
    driver.look(begin,
                {.x = state(kX), .y = state(kY), .yaw = state(kYaw), .u = state(kU), .v = state(kV), .r = state(kR)});
    const Controls now = internal::controls_at(driver, begin, spins);
    controls[0] = at_wheels(now);
    const PerWheel<double> under = heights(state);
    model.rates(state, controls[0], under, rates);
    lift_offs.see(begin, rates.Fz, out.lift_offs);
    out.end_time = begin;
    out.end = internal::ended(state, spins);
    const bool last = k == plan.steps || out.end != DriveEnd::kCompleted;
    if (out.end != DriveEnd::kDiverged && (last || plan.sampled(k))) {
      internal::record(out, begin, state, now, rates, under, spins);
    }
    if (last) break;
    if (!internal::report_progress(progress, k, plan)) {
      out.end = DriveEnd::kInterrupted;
      break;
    }

    const double step = plan.time(k + 1) - begin;
    const int parts =
        spins ? internal::parts_of_step(step * fastest.spins * options.speed, model.parameters(), state) : 1;
    const auto within = [&](double t) { return at_wheels(internal::controls_at(driver, t, spins)); };
    internal::advance(model, heights, within, begin, step, parts, controls, rates, state);
  }
  lift_offs.end(out.end_time, out.lift_offs);
  return out;
}

template <typename Tyre>
VehicleTrajectory simulate(const BicycleModel<double, Tyre>& start, Driver& driver, const SimulationOptions& options,
                           Progress& progress, std::span<const ModelChange<BicycleModel<double, Tyre>>> changes) {
  BicycleModel<double, Tyre> model = start;
  options.validate();
  internal::check_parameters(model.parameters);
  const double u = options.speed;
  {
    // The linear bicycle at the start: two states.
    constexpr double kDifference = 1e-6;
    const auto dv = model.rates(kDifference, 0.0, 0.0, u), dr = model.rates(0.0, kDifference, 0.0, u);
    Eigen::MatrixXd matrix(2, 2);
    matrix << dv.dv, dr.dv, dv.dr, dr.dr;
    internal::check_step(options.step, internal::fastest_eigenvalue(matrix / kDifference));
  }
  const internal::StepPlan plan = internal::plan_steps(options);

  VehicleTrajectory out;
  internal::reserve(out, plan.samples(), false, false);
  const PerWheel<double> loads = static_loads(model.parameters, model.gravity);
  using State = Eigen::Matrix<double, kR + 1, 1>;
  State state = State::Zero();
  state(kU) = u;
  const auto derivative = [&](const State& s, double steer, BicycleRates<double>& rates) {
    rates = model.rates(s(kV), s(kR), steer, u);
    const double c = std::cos(s(kYaw)), sine = std::sin(s(kYaw));
    State d;
    d << u * c - s(kV) * sine, u * sine + s(kV) * c, s(kR), 0.0, rates.dv, rates.dr;
    return d;
  };
  progress.stage("driving");
  for (long k = 0;; ++k) {
    const double begin = plan.time(k), step = plan.time(k + 1) - begin;
    internal::change_model(begin, changes, model);
    driver.look(begin, {.x = state(kX), .y = state(kY), .yaw = state(kYaw), .u = u, .v = state(kV), .r = state(kR)});
    const double steer = internal::controls_at(driver, begin, false).steer;
    BicycleRates<double> rates, unused;
    const State k1 = derivative(state, steer, rates);
    out.end_time = begin;
    out.end = state.allFinite() ? DriveEnd::kCompleted : DriveEnd::kDiverged;
    const bool last = k == plan.steps || out.end != DriveEnd::kCompleted;
    if (out.end != DriveEnd::kDiverged && (last || plan.sampled(k))) {
      internal::record_plane(out, begin, state, steer);
      out.yaw_acceleration.push_back(rates.dr);
      out.longitudinal_acceleration.push_back(-state(kR) * state(kV));
      out.lateral_acceleration.push_back(rates.lateral_acceleration);
      for (std::size_t i = 0; i < kWheels; ++i) {
        const std::size_t axle = is_front(i) ? 0 : 1;
        out.slip_angle[i].push_back(rates.slip_angle[axle]);
        out.Fy[i].push_back(rates.Fy[axle]);
        out.Fz[i].push_back(loads[i]);
      }
    }
    if (last) break;
    if (!internal::report_progress(progress, k, plan)) {
      out.end = DriveEnd::kInterrupted;
      break;
    }
    const double middle = internal::controls_at(driver, begin + 0.5 * step, false).steer;
    const double end = internal::controls_at(driver, begin + step, false).steer;
    const auto rate = [&](numerics::RungeKuttaMoment moment, const State& at) {
      return derivative(at, moment == numerics::RungeKuttaMoment::kMiddle ? middle : end, unused);
    };
    state = numerics::runge_kutta_4_from(k1, rate, state, step);
  }
  return out;
}

}  // namespace veridyn::vehicle
