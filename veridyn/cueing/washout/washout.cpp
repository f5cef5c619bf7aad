#include "veridyn/cueing/washout/washout.hpp"

#include <algorithm>
#include <cmath>

namespace veridyn::cueing {
namespace {

constexpr double kMostForce = 1000.0;  // [m/s^2]
constexpr double kMostRate = 100.0;    // [rad/s]
constexpr double kFurthest = 1e8;      // [m]
constexpr double kMostSpeed = 500.0;   // [m/s]
constexpr double kMostSteer = 1.5;     // [rad]
constexpr double kMostTorque = 1e6;    // [N m]
constexpr double kLongestStep = 10.0;  // [s]
constexpr double kLedIn = 0.4;         // time constant, of second order [s]

void keep_usable(Eigen::Vector3d& values, const Eigen::Vector3d& last, double most) {
  for (Eigen::Index i = 0; i < 3; ++i)
    values(i) = std::isfinite(values(i)) ? std::clamp(values(i), -most, most) : last(i);
}

}  // namespace

void Washout::take(const recording::MotionSample& given) {
  recording::MotionSample sample = recording::in_frame(given, Frame::kFrd);
  keep_usable(sample.force, last_.force, kMostForce);
  keep_usable(sample.rate, last_.rate, kMostRate);
  // What is only foreseen from is left out where it cannot be.
  using recording::Origin;
  const recording::DriverInputs& in = sample.inputs;
  if (!(sample.position.array().abs() < kFurthest).all()) sample.position_from = Origin::kAbsent;
  if (!(std::abs(sample.speed) < kMostSpeed)) sample.speed_from = Origin::kAbsent;
  if (!(std::abs(in.steer) < kMostSteer)) sample.steer_from = Origin::kAbsent;
  if (!(std::abs(in.drive_torque) < kMostTorque && in.brake_torque >= 0.0 && in.brake_torque < kMostTorque))
    sample.torque_from = Origin::kAbsent;
  const double norm = sample.attitude.norm();
  if (!(std::abs(norm - 1.0) < 1e-6)) {
    // An attitude that is far from a rotation is none.
    if (norm > 0.5 && norm < 2.0) {
      sample.attitude.normalize();
    } else {
      sample.attitude = last_.attitude;
    }
  }
  last_ = sample;
}

VehicleMotion Washout::led_in() const {
  const double t = since_reset_ / kLedIn, left = (1.0 + t) * std::exp(-t);
  return {last_.force - left * at_reset_.force, recording::acceleration(last_) - left * at_reset_.acceleration,
          last_.rate - left * at_reset_.rate, &last_};
}

PlatformCommand Washout::reset(const recording::MotionSample& sample) {
  last_ = {};
  last_.frame = Frame::kFrd;
  last_.force = recording::force_at_rest(Frame::kFrd);
  take(sample);
  const Eigen::Vector3d at_rest = recording::force_at_rest(Frame::kFrd);
  at_reset_ = {last_.force - at_rest, recording::acceleration(last_), last_.rate, nullptr};
  since_reset_ = 0.0;
  return next({at_rest, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), &last_}, std::nullopt);
}

PlatformCommand Washout::step(const recording::MotionSample& sample, double step) {
  const double time = step >= 0.0 && std::isfinite(step) ? std::min(step, kLongestStep) : 0.0;
  since_reset_ += time;
  take(sample);
  return next(led_in(), time);
}

}  // namespace veridyn::cueing
