#pragma once

#include <optional>

#include "veridyn/cueing/platform/platform_state.hpp"

namespace veridyn::cueing {

/// Leads one axis after commanded positions and never past its limits. The axis moves on pieces of constant
/// jerk. Of every piece it is made sure, before it begins, that the fastest stop from its end stays within position and
/// rate: so there is always a way to stay within the limits, and the nearer one the earlier the axis brakes. Wanted
/// positions that the limits allow are followed without delay; a step that they do not allow is overshot once by an
/// eighth at most.
///
/// Nothing is allocated or thrown after construction; a copy saves the state.
class AxisGuard {
 public:
  AxisGuard() = default;
  /// @throws InputError as `PlatformLimits::validate`.
  explicit AxisGuard(const AxisLimits& limits);

  /// At rest at a position, or at the nearest within the limits.
  AxisState reset(double position);
  /// @param desired position; beyond the limits: the limit; not finite: the last one
  /// @param step since the last one [s]; below zero or not finite: none. In a gap longer than `kLongestStep` nobody
  ///   knows what was desired: the axis stops, and follows again from the next step on.
  AxisState step(double desired, double step);
  /// The fastest way to rest within the limits, whatever was desired: an emergency stop.
  /// @param step as above
  AxisState brake(double step);
  /// Other limits. Those before stay in force until the axis has been led to where the new ones hold.
  /// @throws InputError as the constructor; then the limits before stay.
  void change_limits(const AxisLimits& limits);

  [[nodiscard]] const AxisState& state() const { return state_; }
  [[nodiscard]] const AxisLimits& limits() const { return limits_; }  ///< in force
  /// Whether a limit held the last step back (of position, rate, acceleration or jerk, or the way that it takes to
  /// stop), and the axis is off the command by more than a thousandth of its range.
  [[nodiscard]] bool limited() const;

  static constexpr double kLongestStep = 0.1;  ///< [s]

 private:
  void follow(double desired, double step, double rate, double acceleration);
  /// The acceleration by which the axis follows, and whether a limit made it less.
  struct Following {
    double acceleration = 0.0;
    bool limited = false;
  };
  [[nodiscard]] Following desired_acceleration(double desired, double rate, double acceleration, double step) const;
  /// The end of a piece of constant jerk, where the piece is allowed.
  [[nodiscard]] std::optional<AxisState> piece(double jerk, double step) const;
  void stop(double step);
  void take_new_limits();

  AxisLimits limits_;
  std::optional<AxisLimits> new_limits_;
  AxisState state_;
  double asked_ = 0.0;  ///< desired, before it was brought within the range
  double desired_ = 0.0, wanted_rate_ = 0.0, wanted_acceleration_ = 0.0;
  double last_step_ = 0.0;
  bool limited_ = false;
};

}  // namespace veridyn::cueing
