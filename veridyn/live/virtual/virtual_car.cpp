#include "veridyn/live/virtual/virtual_car.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/vehicle/simulation/surface_drive.hpp"

namespace veridyn::live {
namespace {

/// Adds to every number of sensors one of a normal distribution, times its size.
void disturb(CarSensors& s, numerics::RandomStream& random, const std::array<double, 4>& sizes) {
  for (double& value : s.acceleration) value += sizes[0] * random.normal();
  for (double& value : s.rate) value += sizes[1] * random.normal();
  s.steering += sizes[2] * random.normal();
  for (double& value : s.wheel_speeds) value += sizes[3] * random.normal();
}

std::unique_ptr<vehicle::SteppedVehicle> on_road(const vehicle::Vehicle& car,
                                                 std::shared_ptr<const vehicle::RoadSurface> surface) {
  const vehicle::FourWheelOptions options = vehicle::four_wheel_options(car);
  const double usual_speed = car.speed.value_or(4.0);
  if (surface) return vehicle::surface_vehicle(car, options, std::move(surface), usual_speed);
  return vehicle::stepped_vehicle(car, options, nullptr, usual_speed);
}

}  // namespace

void VirtualCarOptions::validate() const {
  end.validate();
  if (!(brake_torque > 0.0)) throw InputError("brake", fmt::format("is {} N m; must be > 0", brake_torque));
  if (!(steering_lag >= 0.0 && steering_lag <= 1.0))
    throw InputError("steering_lag", fmt::format("is {} s; must be from 0 to 1", steering_lag));
}

VirtualCar::VirtualCar(const vehicle::Vehicle& vehicle, const VirtualCarOptions& options, std::uint16_t run,
                       std::shared_ptr<const vehicle::RoadSurface> surface)
    : options_(options),
      wheel_radius_(vehicle.longitudinal.wheel_radius),
      vehicle_(on_road(vehicle, std::move(surface))),
      end_(options.end, run),
      random_(options.seed, "virtual car") {
  options_.validate();
  vehicle_->reset(0.0);
  const CarSensorErrors& e = options_.errors;
  disturb(bias_, random_, {e.acceleration_bias, e.rate_bias, e.steering_bias, 0.0});
}

void VirtualCar::receive(Bytes bytes, Nanoseconds now) { end_.receive(bytes, now); }

CarSensors VirtualCar::true_sensors() const {
  const vehicle::DriveState& s = vehicle_->state();
  const recording::MotionSample m = motion();
  CarSensors sensors;
  sensors.acceleration = m.force;
  sensors.rate = m.rate;
  sensors.steering = steer_;
  for (std::size_t wheel = 0; wheel < sensors.wheel_speeds.size(); ++wheel)
    sensors.wheel_speeds[wheel] = s.vehicle(vehicle::kWheelSpin + static_cast<Eigen::Index>(wheel));
  sensors.battery = options_.battery;
  return sensors;
}

void VirtualCar::advance(Nanoseconds now) {
  if (!time_) time_ = now;
  if (now - *time_ > kLongestHoldUp) time_ = now - kLongestHoldUp;
  constexpr double kDt = 1e-9 * static_cast<double>(kStep);
  const double follow = options_.steering_lag > 0.0 ? 1.0 - std::exp(-kDt / options_.steering_lag) : 1.0;
  while (now - *time_ >= kStep) {
    *time_ += kStep;
    actuation_ = end_.step(true_sensors(), *time_);
    const CarCommand& c = actuation_.command;
    steer_ += follow * (c.steering - steer_);
    vehicle_->step({.steer = steer_,
                    .drive_torque = c.drive_force * wheel_radius_,
                    .brake_torque = c.brake * options_.brake_torque},
                   kDt);
  }
}

std::size_t VirtualCar::report(Nanoseconds now, std::span<std::uint8_t> out) {
  CarSensors s = true_sensors();
  s.acceleration += bias_.acceleration;
  s.rate += bias_.rate;
  s.steering += bias_.steering;
  const CarSensorErrors& e = options_.errors;
  disturb(s, random_, {e.acceleration, e.rate, e.steering, e.wheel_speed});
  return end_.report(s, now, out);
}

void CarTruth::add(Nanoseconds time, const VirtualCar& car) {
  const vehicle::DriveState& s = car.state();
  const recording::MotionSample m = car.motion();
  const Eigen::Vector3d place = car.world().position;
  const numerics::EulerAngles angles = numerics::euler_from_quaternion(m.attitude);
  rows_.push_back({{seconds(time), place.x(), place.y(), place.z(), angles.phi, angles.theta, s.vehicle(vehicle::kYaw),
                    s.vehicle(vehicle::kU), s.vehicle(vehicle::kV), s.vehicle(vehicle::kR), m.force.x(), m.force.y(),
                    m.force.z(), s.controls.steer, s.controls.drive_torque, s.controls.brake_torque,
                    static_cast<double>(car.actuation().state)}});
}

std::string CarTruth::csv() const {
  std::string text =
      "# frame: "
      "flu\ntime[s],pos_x[m],pos_y[m],pos_z[m],roll[rad],pitch[rad],yaw[rad],speed[m/s],lateral_velocity[m/"
      "s],yaw_rate[rad/s],"
      "accel_x[m/s^2],accel_y[m/s^2],accel_z[m/s^2],steer[rad],drive_torque[N m],brake_torque[N m],state[1]\n";
  for (const Row& row : rows_) {
    for (std::size_t i = 0; i < row.values.size(); ++i)
      fmt::format_to(std::back_inserter(text), "{}{:.9g}", i > 0 ? "," : "", row.values[i]);
    text += '\n';
  }
  return text;
}

}  // namespace veridyn::live
