#include "tests/vehicle/campaign/rolling_cars.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/vehicle/simulated_drive.hpp"
#include "tests/vehicle/simulation/drives.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"

namespace veridyn::vehicle::testing {
namespace {

struct DrivenAt {
  std::function<Controls(double)> controls;
  double speed = 20.0;
  RollingDriveOptions options;
};

template <typename Tyre>
Tyre with_grip(Tyre tyre, double grip) {
  tyre.stiffness *= grip;
  if constexpr (requires { tyre.mu; }) tyre.mu *= grip;
  return tyre;
}

template <typename Tyre>
VehicleTrajectory driven(const RollingCar& car, const Tyre& front, const Tyre& rear, const DrivenAt& how) {
  using Model = FourWheelModel<double, Tyre>;
  FourWheelOptions options;
  options.relaxation_length = car.relaxation_length;
  const auto on = [&](double grip) {
    const Tyre f = with_grip(front, grip), r = with_grip(rear, grip);
    return Model(car.parameters, {f, f, r, r}, options);
  };
  SignalDriver driver(how.controls);
  Progress silent;
  SimulationOptions simulation;
  simulation.speed = how.speed;
  simulation.duration = how.options.duration_s;
  const std::array change{ModelChange<Model>{.time = how.options.change_s, .model = on(how.options.grip)}};
  return simulate(on(1.0), driver, nullptr, simulation, silent, std::span<const ModelChange<Model>>(change));
}

VehicleTrajectory driven(const RollingCar& car, CarTyre tyre, const DrivenAt& how) {
  const VehicleParameters<double>& p = car.parameters;
  const PerWheel<double> load = static_loads(p, kGravity);
  switch (tyre) {
    case CarTyre::kFiala:
      return driven(car, FialaTyre<double>{.stiffness = p.C_f, .mu = 1.0}, {.stiffness = p.C_r, .mu = 1.0}, how);
    case CarTyre::kMagicFormula: {
      SimpleMagicFormulaTyre<double> front{.stiffness = p.C_f, .mu = 1.0, .C = 1.35, .nominal_load = load[kFrontLeft]};
      // The slope over load halves its growth at 1.6 times the static load; friction falls by a tenth.
      front.stiffness_saturation = 0.7;
      front.mu_load = 0.1;
      SimpleMagicFormulaTyre<double> rear = front;
      rear.stiffness = p.C_r;
      rear.nominal_load = load[kRearLeft];
      return driven(car, front, rear, how);
    }
    case CarTyre::kLinear:
      break;
  }
  return driven(car, LinearTyre<double>{.stiffness = p.C_f}, {.stiffness = p.C_r}, how);
}

}  // namespace

RollingCar rolling_car(std::size_t number) {
  numerics::RandomStream draw(number, "rolling car");
  RollingCar car;
  VehicleParameters<double>& p = car.parameters;
  p.mass = draw.uniform(900.0, 2200.0);
  const double L = draw.uniform(2.3, 3.0);
  p.a = draw.uniform(0.40, 0.55) * L;
  p.b = L - p.a;
  p.cg_height = draw.uniform(0.19, 0.24) * L;
  p.track_f = p.track_r = draw.uniform(0.55, 0.62) * L;
  p.I_z = draw.uniform(0.85, 1.15) * p.mass * p.a * p.b;
  const double sprung = p.mass - 4.0 * p.unsprung_mass, half = 0.5 * p.track_f;
  p.I_x = sprung * std::pow(draw.uniform(0.36, 0.42) * p.track_f, 2);
  const PerWheel<double> load = static_loads(p, kGravity);
  const double front = draw.uniform(14.0, 22.0);
  p.C_f = front * load[kFrontLeft];
  p.C_r = front * draw.uniform(1.0, 1.4) * load[kRearLeft];
  p.K_tf = p.K_tr = 200000.0;
  const double ride = 2.0 * kPi * draw.uniform(1.1, 1.5);
  const double corner_f = load[kFrontLeft] / kGravity - p.unsprung_mass;
  const double corner_r = load[kRearLeft] / kGravity - p.unsprung_mass;
  p.K_sf = corner_f * ride * ride;
  p.K_sr = corner_r * ride * ride;
  const double damping = draw.uniform(0.2, 0.4);
  p.C_sf = 2.0 * damping * corner_f * ride;
  p.C_sr = 2.0 * damping * corner_r * ride;
  // Roll stiffness about the road of springs and bars, gravity's tilting taken off.
  car.roll_gradient = draw.uniform(3.0, 7.0) * kDegree / kGravity;
  const double needed = p.mass * p.cg_height / car.roll_gradient + sprung * kGravity * p.cg_height;
  const double springs = 2.0 * half * half * (p.K_sf + p.K_sr);
  const double bars = std::max(0.0, needed - springs) / (4.0 * half * half);
  const double share = draw.uniform(0.45, 0.65);
  p.K_bf = share * bars;
  p.K_br = (1.0 - share) * bars;
  const double relaxation = draw.uniform(0.2, 0.5);
  car.relaxation_length = number % 3 == 0 ? 0.0 : relaxation;
  return car;
}

VehicleStudy rolling_drive(const RollingCar& car, CarTyre tyre, std::size_t drive, std::uint64_t seed,
                           const RollingDriveOptions& options) {
  constexpr std::array kSpeeds{15.0, 20.0, 25.0};
  const VehicleParameters<double>& p = car.parameters;
  const double speed = kSpeeds[drive % 3];
  const bool gentle = drive < 3;
  const double lateral = gentle ? 0.8 : 1.6;
  const double L = p.wheelbase();
  const double per_lateral = L / (speed * speed) + std::max(0.0, understeer_gradient(p));
  const WanderingSteer steer(seed, lateral * per_lateral, gentle ? 0.05 : 0.1, gentle ? 0.8 : 1.2);
  const auto wanted = [&](double t) {
    const double wider = 1.0 + std::clamp(t - options.livelier_s, 0.0, 1.0);
    return Controls{.steer = wider * steer(t)};
  };
  const VehicleTrajectory trajectory = driven(car, tyre, {.controls = wanted, .speed = speed, .options = options});
  const std::string text = fmt::format(
      "seed = {}\n[subject]\nkind = \"vehicle\"\nname = \"rolling car\"\nmass = {}\na = {}\nb = {}\n[segments]\n"
      "min_speed = 1\n",
      seed, p.mass, p.a, p.b);
  DriveSensorSet sensors = reference_drive_sensors();
  sensors[DriveSensorKind::kPosition].enabled = true;
  for (DriveSensor& sensor : sensors.sensors) sensor.sigma *= options.noise;
  Progress silent;
  VehicleStudy study =
      read_study(Study::parse(text, "rolling_car.toml"), record_drive(trajectory, sensors, seed), silent);
  study.truth = {{"C_f", p.C_f}, {"C_r", p.C_r}, {"I_z", p.I_z}, {"understeer_gradient", understeer_gradient(p)}};
  return study;
}

}  // namespace veridyn::vehicle::testing
