#include "veridyn/cueing/washout/washout.hpp"

#include <algorithm>
#include <cmath>

namespace veridyn::cueing {
namespace {

constexpr double kMostForce = 1000.0;  // [m/s^2]
constexpr double kMostRate = 100.0;    // [rad/s]
constexpr double kLongestStep = 10.0;  // [s]
constexpr double kLedIn = 0.4;         // time constant, of second order [s]

void keep_usable(Eigen::Vector3d& values, const Eigen::Vector3d& last, double most) {
  for (Eigen::Index i = 0; i < 3; ++i)
    values(i) = std::isfinite(values(i)) ? std::clamp(values(i), -most, most) : last(i);
}

}  // namespace

recording::MotionSample Washout::usable(const recording::MotionSample& given) {
  recording::MotionSample sample = recording::in_frame(given, Frame::kFrd);
  keep_usable(sample.force, last_.force, kMostForce);
  keep_usable(sample.rate, last_.rate, kMostRate);
  const double norm = sample.attitude.norm();
  if (std::abs(norm - 1.0) < 1e-6) {
    last_ = sample;
    return sample;
  }
  // An attitude that is far from a rotation is none.
  if (norm > 0.5 && norm < 2.0) {
    sample.attitude.normalize();
  } else {
    sample.attitude = last_.attitude;
  }
  last_ = sample;
  return sample;
}

VehicleMotion Washout::led_in(const recording::MotionSample& sample) const {
  const double t = since_reset_ / kLedIn, left = (1.0 + t) * std::exp(-t);
  return {sample.force - left * at_reset_.force, recording::acceleration(sample) - left * at_reset_.acceleration,
          sample.rate - left * at_reset_.rate};
}

PlatformCommand Washout::reset(const recording::MotionSample& given) {
  last_ = recording::MotionSample{.frame = Frame::kFrd, .force = recording::force_at_rest(Frame::kFrd)};
  const recording::MotionSample sample = usable(given);
  const Eigen::Vector3d at_rest = recording::force_at_rest(Frame::kFrd);
  at_reset_ = {sample.force - at_rest, recording::acceleration(sample), sample.rate};
  since_reset_ = 0.0;
  return next({at_rest, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}, std::nullopt);
}

PlatformCommand Washout::step(const recording::MotionSample& sample, double step) {
  const double time = step >= 0.0 && std::isfinite(step) ? std::min(step, kLongestStep) : 0.0;
  since_reset_ += time;
  return next(led_in(usable(sample)), time);
}

}  // namespace veridyn::cueing
