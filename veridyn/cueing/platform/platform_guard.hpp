#pragma once

#include <bitset>

#include "veridyn/cueing/platform/axis_guard.hpp"

namespace veridyn::cueing {

/// The only way from an algorithm to a platform: leads every axis after the command and never past its limits
/// (`AxisGuard`), whatever the command says.
class PlatformGuard {
 public:
  /// @throws InputError as `PlatformLimits::validate`.
  explicit PlatformGuard(const PlatformLimits& limits);

  /// At rest where the command is, or at the nearest within the limits.
  PlatformState reset(const PlatformCommand& command = {});
  /// Where the platform is to be. @param command only its shift and angle are read
  /// @param step as `AxisGuard::step`
  PlatformState step(const PlatformCommand& command, double step);
  /// As `AxisGuard::brake`, every axis.
  PlatformState brake(double step);
  /// As `AxisGuard::change_limits`, every axis by itself.
  void change_limits(const PlatformLimits& limits);

  [[nodiscard]] const AxisGuard& axis(PlatformAxis which) const { return axes_[which]; }
  [[nodiscard]] PlatformState state() const;
  /// The axes whose last step was held back, by their number.
  [[nodiscard]] std::bitset<kPlatformAxes> limited() const;

 private:
  PerPlatformAxis<AxisGuard> axes_ = {};
  PerPlatformAxis<bool> moves_ = {};
};

}  // namespace veridyn::cueing
