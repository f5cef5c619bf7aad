#include "veridyn/vehicle/manoeuvre/driver_model.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

/// Below this speed a driver does not look ahead [m/s]; the bicycle's stiffness grows as 1/u.
constexpr double kSlowest = 0.5;

using Matrix5 = Eigen::Matrix<double, 5, 5>;

/// exp(M) by squaring the series of M/2^k, |M/2^k| < 1/2: 13 terms leave less than 1e-15 (Moler & Van Loan 2003, method
/// 3).
Matrix5 exponential(const Matrix5& M) {
  const double size = M.cwiseAbs().rowwise().sum().maxCoeff();
  const int halvings = size > 0.5 ? static_cast<int>(std::ceil(std::log2(size / 0.5))) : 0;
  const Matrix5 small = std::ldexp(1.0, -halvings) * M;
  Matrix5 sum = Matrix5::Identity(), term = Matrix5::Identity();
  for (int k = 1; k <= 13; ++k) {
    term = Matrix5(term * small / k);
    sum += term;
  }
  for (int k = 0; k < halvings; ++k) sum = Matrix5(sum * sum);
  return sum;
}

void require(bool good, const char* name, double value, const char* rule) {
  if (!good) throw InputError("driver", fmt::format("{} is {:g}; must be {}", name, value, rule));
}

}  // namespace

void PreviewDriverOptions::validate() const {
  require(preview_time > 0.0 && preview_time < 60.0, "preview_time", preview_time, "> 0 and < 60 s");
  require(delay >= 0.0 && delay < 10.0, "delay", delay, ">= 0 and < 10 s");
  require(lag >= 0.0 && lag < 10.0, "lag", lag, ">= 0 and < 10 s");
  require(max_steer > 0.0 && max_steer < kPi / 2.0, "max_steer", max_steer, "> 0 and < 90 deg");
  require(max_steer_rate > 0.0, "max_steer_rate", max_steer_rate, "> 0");
  require(decision_interval > 0.0 && decision_interval < preview_time, "decision_interval", decision_interval,
          "> 0 and < preview_time");
  require(preview_points >= 4 && preview_points <= 1000, "preview_points", preview_points, "4 .. 1000");
}

PreviewDriver::PreviewDriver(LinearBicycle<double> bicycle, std::shared_ptr<const Path> path,
                             PreviewDriverOptions options)
    : bicycle_(bicycle), path_(std::move(path)), options_(options) {
  VERIDYN_ASSERT(path_ != nullptr);
  options_.validate();
  step_ = options_.preview_time / options_.preview_points;
  const auto points = static_cast<std::size_t>(options_.preview_points);
  from_v_.resize(points);
  from_r_.resize(points);
  from_steer_.resize(points);
  const auto history = static_cast<std::size_t>(std::ceil(options_.delay / options_.decision_interval)) + 8;
  history_time_.resize(history);
  history_steer_.resize(history);
}

void PreviewDriver::predict(double u) {
  // State (v, r, heading error, lateral error, steer) with the steer held: exact steps by the matrix exponential, since
  // the bicycle's rates grow without bound as the speed falls.
  bicycle_.u = u;
  Matrix5 M = Matrix5::Zero();
  M.topLeftCorner<2, 2>() = bicycle_.A();
  M.block<2, 1>(0, 4) = bicycle_.B();
  M(2, 1) = 1.0;
  M(3, 0) = 1.0;
  M(3, 2) = u;
  const Matrix5 one_step = exponential(M * step_);
  Matrix5 to_here = Matrix5::Identity();
  for (std::size_t i = 0; i < from_v_.size(); ++i) {
    to_here = Matrix5(one_step * to_here);
    from_v_[i] = to_here(3, 0);
    from_r_[i] = to_here(3, 1);
    from_steer_[i] = to_here(3, 4);
  }
  predicted_speed_ = u;
}

double PreviewDriver::decide(const PlanarMotion& motion) {
  const PathPoint here = path_->at(s_);
  const double c = std::cos(here.heading), s = std::sin(here.heading);
  lateral_error_ = (motion.y - here.y) * c - (motion.x - here.x) * s;
  const double u = std::max(motion.u, kSlowest);
  if (std::abs(u - predicted_speed_) > 0.01 * u) predict(u);
  const double heading_error = std::remainder(motion.yaw - here.heading, 2.0 * kPi);
  double numerator = 0.0, denominator = 0.0;
  double road = 0.0;  // lateral position of the straightened path, the integral of u times its turn
  double turn_before = 0.0;
  for (std::size_t i = 0; i < from_v_.size(); ++i) {
    const double eta = step_ * static_cast<double>(i + 1);
    const double turn = path_->at(s_ + u * eta).heading - here.heading;
    road += 0.5 * step_ * u * (turn_before + turn);
    turn_before = turn;
    const double free = lateral_error_ + u * eta * heading_error + from_v_[i] * motion.v + from_r_[i] * motion.r;
    numerator += (road - free) * from_steer_[i];
    denominator += from_steer_[i] * from_steer_[i];
  }
  return std::clamp(numerator / denominator, -options_.max_steer, options_.max_steer);
}

void PreviewDriver::record(double time, double steer) {
  const std::size_t capacity = history_time_.size();
  const std::size_t at = (history_begin_ + history_size_) % capacity;
  history_time_[at] = time;
  history_steer_[at] = steer;
  if (history_size_ < capacity) {
    ++history_size_;
  } else {
    history_begin_ = (history_begin_ + 1) % capacity;
  }
}

void PreviewDriver::look(double time, const PlanarMotion& motion) {
  if (!started_ || time < last_decision_) {
    started_ = true;
    history_begin_ = history_size_ = 0;
    predicted_speed_ = 0.0;
    s_ = path_->nearest(motion.x, motion.y);
    record(time, 0.0);
    last_decision_ = time;
    return;
  }
  const double since = time - last_decision_;
  if (since < options_.decision_interval * (1.0 - 1e-6)) return;
  last_decision_ = time;
  s_ = path_->nearest(motion.x, motion.y, s_ + motion.u * since,
                      std::max(2.0 * since * motion.u, 0.1 * bicycle_.wheelbase()));
  const std::size_t newest = (history_begin_ + history_size_ - 1) % history_time_.size();
  const double before = history_steer_[newest];
  double steer = motion.u < kSlowest ? before : decide(motion);
  if (options_.lag > 0.0) steer = before + (1.0 - std::exp(-since / options_.lag)) * (steer - before);
  const double most = options_.max_steer_rate * since;
  record(time, std::clamp(steer, before - most, before + most));
}

Controls PreviewDriver::controls(double time) const {
  // The decision one delay ago, straight between decisions.
  const double then = time - options_.delay;
  const std::size_t capacity = history_time_.size();
  double later_time = 0.0, later_steer = 0.0;
  for (std::size_t k = 0; k < history_size_; ++k) {
    const std::size_t i = (history_begin_ + history_size_ - 1 - k) % capacity;
    if (history_time_[i] <= then) {
      if (k == 0) return {.steer = history_steer_[i]};
      const double share = (then - history_time_[i]) / (later_time - history_time_[i]);
      return {.steer = history_steer_[i] + share * (later_steer - history_steer_[i])};
    }
    later_time = history_time_[i];
    later_steer = history_steer_[i];
  }
  return {.steer = history_size_ > 0 ? later_steer : 0.0};
}

void SpeedControllerOptions::validate() const {
  require(mass > 0.0, "mass", mass, "> 0");
  require(wheel_radius > 0.0, "wheel_radius", wheel_radius, "> 0");
  require(proportional > 0.0, "proportional", proportional, "> 0");
  require(integral >= 0.0, "integral", integral, ">= 0");
  require(max_acceleration > 0.0, "max_acceleration", max_acceleration, "> 0");
  require(max_deceleration > 0.0, "max_deceleration", max_deceleration, "> 0");
}

SpeedControlledDriver::SpeedControlledDriver(std::unique_ptr<Driver> steering, PiecewiseLinear speed,
                                             SpeedControllerOptions options)
    : steering_(std::move(steering)), speed_(std::move(speed)), options_(options) {
  VERIDYN_ASSERT(steering_ != nullptr && !speed_.empty());
  options_.validate();
}

void SpeedControlledDriver::look(double time, const PlanarMotion& motion) {
  steering_->look(time, motion);
  if (!(time >= last_)) {
    last_ = time;
    integral_ = 0.0;
  }
  const double since = time - last_;
  last_ = time;
  const double error = speed_(time) - motion.u;
  const double desired = options_.proportional * error + integral_ + options_.integral * error * since;
  const double given = std::clamp(desired, -options_.max_deceleration, options_.max_acceleration);
  // The integral is held while it would only push further into a limit.
  if (given == desired || (desired - given) * error < 0.0) integral_ += options_.integral * error * since;
  torque_ = options_.mass * options_.wheel_radius * given;
}

Controls SpeedControlledDriver::controls(double time) const {
  Controls controls = steering_->controls(time);
  controls.drive_torque += std::max(torque_, 0.0);
  controls.brake_torque += std::max(-torque_, 0.0);
  return controls;
}

}  // namespace veridyn::vehicle
