#include "veridyn/cueing/platform/platform_guard.hpp"

namespace veridyn::cueing {

double position(const PlatformCommand& command, PlatformAxis axis) {
  const auto i = static_cast<Eigen::Index>(axis);
  return turns(axis) ? command.angle(i - 3) : command.shift(i);
}

PlatformGuard::PlatformGuard(const PlatformLimits& limits) {
  limits.validate();
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    moves_[i] = limits.axes[i].moves();
    if (moves_[i]) axes_[i] = AxisGuard(limits.axes[i]);
  }
}

PlatformCommand PlatformGuard::reset(const PlatformCommand& at) {
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    if (moves_[i]) axes_[i].reset(position(at, static_cast<PlatformAxis>(i)));
  }
  return command();
}

PlatformCommand PlatformGuard::step(const PlatformCommand& wanted, double step) {
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    if (moves_[i]) axes_[i].step(position(wanted, static_cast<PlatformAxis>(i)), step);
  }
  return command();
}

void PlatformGuard::change_limits(const PlatformLimits& limits) {
  limits.validate();
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    if (moves_[i] && limits.axes[i].moves()) axes_[i].change_limits(limits.axes[i]);
  }
}

std::bitset<kPlatformAxes> PlatformGuard::limited() const {
  std::bitset<kPlatformAxes> which;
  for (std::size_t i = 0; i < kPlatformAxes; ++i) which[i] = moves_[i] && axes_[i].limited();
  return which;
}

PlatformCommand PlatformGuard::command() const {
  PlatformCommand c;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    c.shift(axis) = axes_[i].state().position;
    c.acceleration(axis) = axes_[i].state().acceleration;
    c.angle(axis) = axes_[i + 3].state().position;
    c.rate(axis) = axes_[i + 3].state().rate;
  }
  return c;
}

}  // namespace veridyn::cueing
