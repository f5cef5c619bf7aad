#include "veridyn/cueing/washout/driver_foresight.hpp"

#include <algorithm>
#include <cmath>

namespace veridyn::cueing {
namespace {

constexpr double kBetweenLooks = 0.0095;  // [s]
constexpr double kBeginsAnew = 1.0;       // step after which the model does [s]
/// The model goes no slower, as slip angles have no value at rest: below, forces to the side are those at this speed,
/// less by the square of the speed [m/s].
constexpr double kSlowest = 3.0;
/// Nobody holds the wheel still for long: from then on forces fade, with this time constant [s].
constexpr double kHeld = 1.0, kThenFades = 1.5;
constexpr double kUsualGrip = 1.0;  // where the tyres' own friction is not one number

vehicle::Controls controls_of(const recording::MotionSample& sample) {
  const recording::DriverInputs& in = sample.inputs;
  if (sample.torque_from == recording::Origin::kAbsent) return {.steer = in.steer};
  return {in.steer, in.drive_torque, in.brake_torque};
}

std::unique_ptr<vehicle::SteppedVehicle> at_given_speed(const vehicle::Vehicle& of) {
  vehicle::FourWheelOptions options = vehicle::four_wheel_options(of);
  options.longitudinal.reset();
  return vehicle::stepped_vehicle(of, options, nullptr, kSlowest);
}

}  // namespace

DriverForesight::DriverForesight(const vehicle::Vehicle& of)
    : vehicle_(at_given_speed(of)), longitudinal_(of.longitudinal) {
  const double r = longitudinal_.wheel_radius, mass = of.parameters.mass;
  mass_ = mass + 4.0 * longitudinal_.wheel_inertia / (r * r);
  weight_ = mass * kGravity;
  grip_ = weight_ * std::min(of.parameters.mu, kUsualGrip);
}

double DriverForesight::acceleration(const vehicle::Controls& c, double speed) const {
  const vehicle::LongitudinalParameters& l = longitudinal_;
  const double drag = 0.5 * l.air_density * l.drag_area * speed * std::abs(speed);
  const double along = c.drive_torque / l.wheel_radius - drag;
  const double against = c.brake_torque / l.wheel_radius + l.rolling_resistance * weight_;
  // What rubs holds a vehicle that stands.
  const double rubbed =
      speed != 0.0 ? along - std::copysign(against, speed) : along - std::clamp(along, -against, against);
  return std::clamp(rubbed, -grip_, grip_) / mass_;
}

void DriverForesight::set_speed(double speed) {
  speed_ = speed;
  vehicle::DriveState state = vehicle_->state();
  state.vehicle(vehicle::kU) = std::max(std::abs(speed), kSlowest);
  vehicle_->reset(state);
}

Eigen::Vector3d DriverForesight::force(const vehicle::Controls& controls, const Eigen::Vector3d& place) const {
  Eigen::Vector3d f = recording::in_frame(vehicle_->motion(place), Frame::kFrd).force;
  if (knows_torques_) f.x() += acceleration(controls, speed_);
  const double share = std::min(std::abs(speed_) / kSlowest, 1.0);
  f.y() *= share * share;
  return f;
}

bool DriverForesight::look(const recording::MotionSample& sample, double step, Foreseen& foreseen) {
  using recording::Origin;
  if (sample.steer_from == Origin::kAbsent) {
    runs_ = false;
    return false;
  }
  const vehicle::Controls controls = controls_of(sample);
  knows_torques_ = sample.torque_from != Origin::kAbsent;
  const auto drive_on = [&](double time) {
    vehicle_->step(controls, time);
    if (!knows_torques_) return;
    const double then = speed_ + acceleration(controls, speed_) * time;
    set_speed(speed_ * then < 0.0 ? 0.0 : then);
  };
  const double measured = sample.speed_from == Origin::kAbsent ? speed_ : sample.speed;
  if (!runs_ || step > kBeginsAnew) {
    vehicle_->reset(std::max(std::abs(measured), kSlowest));
    since_ahead_ = kBetweenLooks;
  } else {
    drive_on(step);
    since_ahead_ += step;
  }
  runs_ = true;
  set_speed(sample.speed_from == Origin::kAbsent ? speed_ : measured);
  vehicle::DriveState now = vehicle_->state();
  now.controls = controls;
  // At walking pace the model turns as at its slowest.
  if (sample.rate_from != Origin::kAbsent && std::abs(speed_) >= kSlowest) now.vehicle(vehicle::kR) = -sample.rate.z();
  vehicle_->reset(now);
  if (since_ahead_ >= kBetweenLooks) {
    since_ahead_ = 0.0;
    const Eigen::Vector3d place = recording::in_frame(sample, Frame::kFlu).place;
    const double speed = speed_;
    last_.now = force(controls, place);
    double at = 0.0;
    for (std::size_t k = 0; k < kForeseenSteps; ++k) {
      drive_on(foreseen_middle(k) - at);
      at = foreseen_middle(k);
      last_.then[k] = force(controls, place);
      last_.then[k].head<2>() *= std::exp(-std::max(at - kHeld, 0.0) / kThenFades);
    }
    vehicle_->reset(now);
    speed_ = speed;
  }
  foreseen = last_;
  return true;
}

}  // namespace veridyn::cueing
