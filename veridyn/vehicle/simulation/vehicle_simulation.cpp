#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"
#include "veridyn/vehicle/model/four_wheel_models.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation_loop.hpp"

namespace veridyn::vehicle {

namespace {

/// The step times the fastest rate that the Runge-Kutta method of order 4 follows: it is stable to 2.79 on the real and
/// 2.83 on the imaginary axis.
constexpr double kStableStep = 2.5;

[[noreturn]] void reject(const std::string& what) { throw InputError("drive", what); }

}  // namespace

void SimulationOptions::validate() const {
  constexpr double kMostSteps = 1e9;
  if (!(speed > 0.0 && speed < kInfinity)) reject(fmt::format("speed is {:g} m/s; must be > 0", speed));
  if (!(duration > 0.0 && duration < kInfinity)) reject(fmt::format("duration is {:g} s; must be > 0", duration));
  if (!(step > 0.0 && step < kInfinity)) reject(fmt::format("step is {:g} s; must be > 0", step));
  if (!(step <= duration)) {
    reject(fmt::format("step is {:g} s; must not be longer than the duration of {:g} s", step, duration));
  }
  if (!(duration / step <= kMostSteps)) {
    reject(fmt::format("step is {:g} s; {:g} s would take more than 1e9 steps", step, duration));
  }
  const double ratio = output_step / step;
  if (!(ratio >= 0.5 && output_step < kInfinity && std::abs(ratio - std::round(ratio)) <= 1e-6 * ratio)) {
    reject(fmt::format("output_step is {:g} s; must be a multiple of the step of {:g} s", output_step, step));
  }
}

namespace internal {

void check_controls(const Controls& controls, double time, bool with_torques) {
  if (!(std::abs(controls.steer) < 90.0 * kDegree)) {
    reject(fmt::format("steer is {:g} deg at {:.3f} s; must be within -90 and 90 deg", controls.steer / kDegree, time));
  }
  if (!with_torques) return;
  if (!(controls.brake_torque >= 0.0 && controls.brake_torque < kInfinity)) {
    reject(fmt::format("brake_torque is {:g} N m at {:.3f} s; must be >= 0", controls.brake_torque, time));
  }
  if (!(std::abs(controls.drive_torque) < kInfinity)) {
    reject(fmt::format("drive_torque is {:g} N m at {:.3f} s; must be finite", controls.drive_torque, time));
  }
}

void check_parameters(const VehicleParameters<double>& parameters) {
  if (const std::string why = inadmissible(parameters); !why.empty()) throw InputError("vehicle", why);
}

double fastest_eigenvalue(const Eigen::MatrixXd& matrix) {
  if (!matrix.allFinite()) return kInfinity;
  return numerics::general_eigenvalues(matrix).cwiseAbs().maxCoeff();
}

void check_step(double step, double fastest) {
  if (step * fastest <= kStableStep) return;
  if (!(fastest < kInfinity)) reject("the forces at the start are not finite: check tyres and parameters");
  reject(fmt::format("step is {:g} s; this vehicle's fastest motion ({:.4g} 1/s) needs at most {:.2g} s", step, fastest,
                     kStableStep / fastest));
}

StepPlan plan_steps(const SimulationOptions& options) {
  StepPlan plan;
  plan.step = options.step;
  plan.duration = options.duration;
  plan.steps = static_cast<long>(std::ceil(options.duration / options.step * (1.0 - 1e-12)));
  plan.per_sample = std::lround(options.output_step / options.step);
  return plan;
}

void reserve(VehicleTrajectory& out, std::size_t samples, bool vertical, bool spins) {
  for (auto* column : {&out.time, &out.x, &out.y, &out.yaw, &out.u, &out.v, &out.r, &out.yaw_acceleration,
                       &out.longitudinal_acceleration, &out.lateral_acceleration, &out.steer}) {
    column->reserve(samples);
  }
  const auto reserve_wheels = [&](PerWheel<std::vector<double>>& columns) {
    for (std::vector<double>& column : columns) column.reserve(samples);
  };
  for (auto* columns : {&out.slip_angle, &out.Fy, &out.Fz}) reserve_wheels(*columns);
  if (!vertical) return;
  for (auto* column : {&out.roll, &out.pitch, &out.heave, &out.roll_rate, &out.pitch_rate, &out.heave_rate,
                       &out.roll_acceleration, &out.pitch_acceleration, &out.heave_acceleration}) {
    column->reserve(samples);
  }
  for (auto* columns : {&out.Fx, &out.wheel_height, &out.suspension_travel, &out.road}) reserve_wheels(*columns);
  if (spins) {
    out.drive_torque.reserve(samples);
    out.brake_torque.reserve(samples);
    reserve_wheels(out.slip_ratio);
    reserve_wheels(out.wheel_speed);
  }
  out.lift_offs.reserve(64);
}

void record(VehicleTrajectory& out, double time, const FourWheelState<double>& s, const Controls& controls,
            const FourWheelRates<double>& rates, const PerWheel<double>& road, bool spins) {
  record_plane(out, time, s, controls.steer);
  if (spins) {
    out.drive_torque.push_back(controls.drive_torque);
    out.brake_torque.push_back(controls.brake_torque);
  }
  out.yaw_acceleration.push_back(rates.derivative(kR));
  out.longitudinal_acceleration.push_back(rates.longitudinal_acceleration);
  out.lateral_acceleration.push_back(rates.lateral_acceleration);
  out.roll.push_back(s(kRoll));
  out.pitch.push_back(s(kPitch));
  out.heave.push_back(s(kHeave));
  out.roll_rate.push_back(s(kRollRate));
  out.pitch_rate.push_back(s(kPitchRate));
  out.heave_rate.push_back(s(kHeaveRate));
  out.roll_acceleration.push_back(rates.derivative(kRollRate));
  out.pitch_acceleration.push_back(rates.derivative(kPitchRate));
  out.heave_acceleration.push_back(rates.derivative(kHeaveRate));
  for (std::size_t i = 0; i < kWheels; ++i) {
    out.slip_angle[i].push_back(rates.slip_angle[i]);
    out.Fx[i].push_back(rates.Fx[i]);
    out.Fy[i].push_back(rates.Fy[i]);
    out.Fz[i].push_back(rates.Fz[i]);
    out.wheel_height[i].push_back(s(kWheelHeight + i));
    out.suspension_travel[i].push_back(rates.suspension_travel[i]);
    out.road[i].push_back(road[i]);
    if (!spins) continue;
    out.slip_ratio[i].push_back(rates.slip_ratio[i]);
    out.wheel_speed[i].push_back(s(kWheelSpin + i));
  }
}

void LiftOffs::change(double time, const WheelArray<double>& normal_force, std::vector<LiftOff>& found) {
  any_off_ = false;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const bool off = !(normal_force[i] > 0.0), was_off = since_[i] >= 0.0;
    if (off && !was_off) since_[i] = time;
    if (!off && was_off) {
      found.push_back({.wheel = i, .from = since_[i], .to = time});
      since_[i] = -1.0;
    }
    any_off_ |= off;
  }
}

void LiftOffs::end(double time, std::vector<LiftOff>& found) const {
  for (std::size_t i = 0; i < kWheels; ++i) {
    if (since_[i] >= 0.0) found.push_back({.wheel = i, .from = since_[i], .to = time});
  }
}

DriveEnd ended(const FourWheelState<double>& s, bool speed_varies) {
  constexpr double kStandstill = 0.5;
  constexpr double kOver = 45.0 * kDegree;
  // A sum is finite where its terms are; far cheaper than asking each.
  if (!(std::abs(s.sum()) < kInfinity)) return DriveEnd::kDiverged;
  if (std::abs(s(kRoll)) > kOver || std::abs(s(kPitch)) > kOver) return DriveEnd::kRolledOver;
  if (speed_varies && s(kU) < kStandstill) {
    if (std::abs(s(kV)) < kStandstill) return DriveEnd::kStopped;
    if (s(kU) < 0.0) return DriveEnd::kSpun;
  }
  return DriveEnd::kCompleted;
}

}  // namespace internal

// NOLINTBEGIN(bugprone-macro-parentheses): the name of a template takes none
#define VERIDYN_SIMULATE_ON(Tyre)                                                                                   \
  template VehicleTrajectory simulate(const FourWheelModel<double, Tyre<double>>&, Driver&, const Road*,            \
                                      const SimulationOptions&, Progress&,                                          \
                                      std::span<const ModelChange<FourWheelModel<double, Tyre<double>>>>);          \
  template VehicleTrajectory simulate(const BicycleModel<double, Tyre<double>>&, Driver&, const SimulationOptions&, \
                                      Progress&, std::span<const ModelChange<BicycleModel<double, Tyre<double>>>>);
VERIDYN_TYRE_LAWS(VERIDYN_SIMULATE_ON)
#undef VERIDYN_SIMULATE_ON
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace veridyn::vehicle
