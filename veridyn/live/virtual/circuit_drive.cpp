#include "veridyn/live/virtual/circuit_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/vehicle/simulation/surface_drive.hpp"

namespace veridyn::live {

using vehicle::DriveState;

const KeyTable<CircuitDriveOptions>& CircuitDriveOptions::keys() {
  using O = CircuitDriveOptions;
  static const auto table = KeyTable<O>("live.circuit", "How the virtual car drives around its circuit.")
                                .number("speed", &O::speed, "m/s", kPositive, "that it holds, uphill and downhill")
                                .count("laps", &O::laps, 1, 1000, "until it is put back to the start")
                                .choice("direction", &O::clockwise, {{"counter-clockwise", false}, {"clockwise", true}},
                                        "which way round, ramps and banks too");
  return table;
}

CircuitDriver::CircuitDriver(std::shared_ptr<const vehicle::Circuit> circuit, const CircuitDriveOptions& options,
                             double wheelbase, double mass, double wheel_radius)
    : circuit_(std::move(circuit)),
      options_(options),
      wheelbase_(wheelbase),
      mass_(mass),
      wheel_radius_(wheel_radius) {}

vehicle::Controls CircuitDriver::controls(const DriveState& state, double dt) {
  const Eigen::Vector2d place(state.vehicle(vehicle::kX), state.vehicle(vehicle::kY));
  const double ahead = 1.5 * wheelbase_ + 0.15 * options_.speed, sense = options_.clockwise ? -1.0 : 1.0;
  const Eigen::Vector2d to = circuit_->middle(circuit_->locate(place).distance + sense * ahead) - place;
  const double bearing = std::atan2(to.y(), to.x()) - state.vehicle(vehicle::kYaw);
  // A controller of speed with 2 rad/s, whose integral carries the car on a grade.
  constexpr double kFollows = 4.0, kCarries = 4.0, kMaxAcceleration = 8.0;  // [1/s], [1/s^2], [m/s^2]
  const double missing = options_.speed - state.vehicle(vehicle::kU);
  integral_ = std::clamp(integral_ + missing * dt, -kMaxAcceleration / kCarries, kMaxAcceleration / kCarries);
  const double torque = mass_ * wheel_radius_ *
                        std::clamp(kFollows * missing + kCarries * integral_, -kMaxAcceleration, kMaxAcceleration);
  return {.steer = std::clamp(std::atan(2.0 * wheelbase_ * std::sin(bearing) / to.norm()), -0.6, 0.6),
          .drive_torque = std::max(torque, 0.0),
          .brake_torque = std::max(-torque, 0.0)};
}

DriveState CircuitDriver::at_start(DriveState upright) const {
  upright.vehicle(vehicle::kX) = upright.vehicle(vehicle::kY) = 0.0;
  upright.vehicle(vehicle::kYaw) = options_.clockwise ? kPi : 0.0;
  return upright;
}

std::vector<PacketedMotion> circuit_drive(const vehicle::Vehicle& vehicle,
                                          const std::shared_ptr<const vehicle::Circuit>& circuit,
                                          const CircuitDriveOptions& options, const Eigen::Vector3d& place) {
  constexpr double kStep = 1e-3;
  constexpr int kPerMotion = 5;
  const auto car = vehicle::surface_vehicle(vehicle, vehicle::four_wheel_options(vehicle), circuit, options.speed);
  CircuitDriver driver(circuit, options, vehicle.parameters.wheelbase(), vehicle.parameters.mass,
                       vehicle.longitudinal.wheel_radius);
  car->reset(driver.at_start(car->state()));
  const double length = static_cast<double>(options.laps) * circuit->length();
  const double longest = 10.0 + 3.0 * length / options.speed;
  std::vector<PacketedMotion> motions;
  while (car->state().vehicle(vehicle::kDistance) < length) {
    const recording::MotionSample m = car->motion(place);
    const vehicle::WorldMotion at = car->world();
    const vehicle::Circuit::Located on = circuit->locate(at.position.head<2>());
    if (!(std::abs(on.offset) < 0.5 * circuit->options().width) || m.time > longest)
      throw InputError("circuit",
                       fmt::format("at {:g} m/s the car {} {:.1f} m after the start of its lap", options.speed,
                                   m.time > longest ? "gets no farther than" : "leaves the road", on.distance));
    // The place is held to the centre of gravity by the body.
    const Eigen::Vector3d arm = m.attitude * place;
    motions.push_back({.sequence = 0,
                       .time = m.time,
                       .position = at.position + arm,
                       .velocity = at.velocity + (m.attitude * m.rate).cross(arm),
                       .force = m.force,
                       .rate = m.rate,
                       .attitude = m.attitude});
    for (int k = 0; k < kPerMotion; ++k) car->step(driver.controls(car->state(), kStep), kStep);
  }
  return motions;
}

}  // namespace veridyn::live
