#include "veridyn/cueing/platform/platform_guard.hpp"

namespace veridyn::cueing {

PlatformGuard::PlatformGuard(const PlatformLimits& limits) {
  limits.validate();
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    moves_[i] = limits.axes[i].moves();
    if (moves_[i]) axes_[i] = AxisGuard(limits.axes[i]);
  }
}

PlatformState PlatformGuard::reset(const PlatformCommand& at) {
  for (const PlatformAxis i : kAllPlatformAxes) {
    if (moves_[i]) axes_[i].reset(position(at, i));
  }
  return state();
}

PlatformState PlatformGuard::step(const PlatformCommand& desired, double step) {
  for (const PlatformAxis i : kAllPlatformAxes) {
    if (moves_[i]) axes_[i].step(position(desired, i), step);
  }
  return state();
}

PlatformState PlatformGuard::brake(double step) {
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    if (moves_[i]) axes_[i].brake(step);
  }
  return state();
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

PlatformState PlatformGuard::state() const {
  PlatformState s;
  for (const PlatformAxis i : kAllPlatformAxes) set_axis(s, i, axes_[i].state());
  return s;
}

}  // namespace veridyn::cueing
