#pragma once

#include <bitset>

#include "veridyn/cueing/platform/axis_guard.hpp"
#include "veridyn/cueing/platform/platform_command.hpp"

namespace veridyn::cueing {

/// The only way from an algorithm to a platform: leads every axis after the command and never past its limits
/// (`AxisGuard`), whatever the command says.
class PlatformGuard {
 public:
  /// @throws InputError as `PlatformLimits::validate`.
  explicit PlatformGuard(const PlatformLimits& limits);

  /// At rest where the command is, or at the nearest within the limits.
  PlatformCommand reset(const PlatformCommand& command = {});
  /// @param command only its shift and angle are read; those of the answer are where the platform is to be, with the
  ///   acceleration of its shift and the rate of its angles
  /// @param step as `AxisGuard::step`
  PlatformCommand step(const PlatformCommand& command, double step);
  /// As `AxisGuard::change_limits`, every axis by itself.
  void change_limits(const PlatformLimits& limits);

  [[nodiscard]] const AxisGuard& axis(PlatformAxis which) const { return axes_[which]; }
  /// The axes whose last step was held back, by their number.
  [[nodiscard]] std::bitset<kPlatformAxes> limited() const;

 private:
  [[nodiscard]] PlatformCommand command() const;

  PerPlatformAxis<AxisGuard> axes_ = {};
  PerPlatformAxis<bool> moves_ = {};
};

/// Shift and angle of a command, axis by axis.
[[nodiscard]] double position(const PlatformCommand& command, PlatformAxis axis);

}  // namespace veridyn::cueing
