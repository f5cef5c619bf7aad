#include "veridyn/cueing/platform/platform_simulator.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/index.hpp"

namespace veridyn::cueing {

void DelayLine::reset(double value) {
  count_ = 1;
  newest_ = 0;
  time_ = times_[0] = 0.0;
  values_[0] = value;
}

double DelayLine::step(double value, double step) {
  if (!(delay_ > 0.0)) return value;
  time_ += step;
  newest_ = (newest_ + 1) % kSamples;
  count_ = std::min(count_ + 1, kSamples);
  times_[newest_] = time_;
  values_[newest_] = value;
  const double then = time_ - delay_;
  for (std::size_t back = 1; back < count_; ++back) {
    const std::size_t older = (newest_ + kSamples - back) % kSamples, newer = (older + 1) % kSamples;
    if (times_[older] > then) continue;
    const double between = times_[newer] - times_[older];
    const double part = between > 0.0 ? std::min((then - times_[older]) / between, 1.0) : 1.0;
    return values_[older] + part * (values_[newer] - values_[older]);
  }
  return values_[(newest_ + kSamples - (count_ - 1)) % kSamples];
}

PlatformSimulator::Actuator PlatformSimulator::actuator(const ActuatorOptions& o) const {
  const bool at_once = o.omega == 0.0;
  const double omega = at_once ? 1.0 : o.omega;
  const auto follows = [&](std::vector<double> numerator) {
    for (double& c : numerator) c *= omega * omega;
    return numerics::CausalFilter(
        numerics::TransferFunction{std::move(numerator), {1.0, 2.0 * o.zeta * omega, omega * omega}});
  };
  Actuator a{.guard = std::nullopt,
             .delay = DelayLine(o.delay),
             .follows = {follows({1.0}), follows({1.0, 0.0}), follows({1.0, 0.0, 0.0})},
             .at_once = at_once};
  return a;
}

AxisState PlatformSimulator::Actuator::reset(double ordered) {
  if (guard) ordered = guard->reset(ordered).position;
  delay.reset(ordered);
  for (numerics::CausalFilter& f : follows) f.reset(ordered);
  return last = {ordered, 0.0, 0.0};
}

AxisState PlatformSimulator::Actuator::step(const AxisState& ordered, double step) {
  AxisState to = guard ? guard->step(ordered.position, step) : ordered;
  if (at_once) return last = to;
  const double position = delay.step(to.position, step);
  return last = {follows[0].step(position, step), follows[1].step(position, step), follows[2].step(position, step)};
}

PlatformSimulator::PlatformSimulator(const Platform& platform) : platform_((platform.validate(), platform)) {
  if (platform.legs) legs_.emplace(*platform.legs, platform.limits);
  bool by_axes = false;
  for (const PlatformAxis which : kAllPlatformAxes) by_axes = by_axes || platform.axis_actuators[which].has_value();
  if (!legs_ || by_axes) {
    std::vector<Actuator>& axes = legs_ ? axes_ : actuators_;
    for (const PlatformAxis which : kAllPlatformAxes) axes.push_back(actuator(platform.response(which)));
  }
  for (Eigen::Index i = 0; legs_ && i < legs_->count(); ++i) {
    actuators_.push_back(
        actuator(by_axes ? ActuatorOptions{.omega = 0.0, .zeta = 1.0, .delay = 0.0} : platform.actuators));
    actuators_.back().guard.emplace(platform.legs->leg);
  }
  reset({});
}

PlatformState PlatformSimulator::reset(const PlatformState& ordered) { return act(ordered, std::nullopt); }

PlatformState PlatformSimulator::step(const PlatformState& ordered, double step) {
  return act(ordered, step > 0.0 && std::isfinite(step) ? step : 0.0);
}

PlatformState PlatformSimulator::act(const PlatformState& ordered, std::optional<double> step) {
  if (step && *step == 0.0) return state_;
  if (legs_) {
    before_reach_ = act_on_legs(axes_.empty() ? ordered : act_on_axes(axes_, ordered, step), step);
  } else {
    before_reach_ = act_on_axes(actuators_, ordered, step);
  }
  state_ = at_rest_places(before_reach_);
  return state_;
}

PlatformState PlatformSimulator::act_on_axes(std::vector<Actuator>& axes, const PlatformState& ordered,
                                             std::optional<double> step) {
  PlatformState reached;
  for (const PlatformAxis which : kAllPlatformAxes) {
    const AxisState to = axis(ordered, which);
    Actuator& a = axes[static_cast<std::size_t>(which)];
    set_axis(reached, which, step ? a.step(to, *step) : a.reset(to.position));
  }
  return reached;
}

PlatformState PlatformSimulator::act_on_legs(const PlatformState& ordered, std::optional<double> step) {
  const Legs::Lengths desired = legs_->lengths(ordered);
  Legs::Lengths reached = desired;
  for (Eigen::Index i = 0; i < legs_->count(); ++i) {
    Actuator& a = actuators_[at(i)];
    const AxisState to = step ? a.step({desired.position(i), desired.rate(i), desired.acceleration(i)}, *step)
                              : a.reset(desired.position(i));
    reached.position(i) = to.position;
    reached.rate(i) = to.rate;
    reached.acceleration(i) = to.acceleration;
  }
  leg_positions_ = reached.position;
  leg_rates_ = reached.rate;
  // Lengths that belong to no pose do not come up: the legs follow together from poses that are.
  return legs_->state(reached, before_reach_).value_or(before_reach_);
}

PlatformState PlatformSimulator::at_rest_places(const PlatformState& s) const {
  PlatformState reached = s;
  for (const PlatformAxis which : kAllPlatformAxes) {
    if (platform_.reach[which].empty()) continue;
    AxisState a = axis(s, which);
    const StaticReach::Point there = platform_.reach[which].at(a.position);
    a = {there.reached, there.slope * a.rate, there.slope * a.acceleration};
    set_axis(reached, which, a);
  }
  return reached;
}

}  // namespace veridyn::cueing
