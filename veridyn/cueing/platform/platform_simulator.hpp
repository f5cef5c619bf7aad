#pragma once

#include <array>
#include <optional>

#include "veridyn/cueing/platform/axis_guard.hpp"
#include "veridyn/cueing/platform/platform.hpp"
#include "veridyn/numerics/linear_systems/causal_filter.hpp"

namespace veridyn::cueing {

/// Gives back what it was given a fixed time ago, on lines between the samples.
class DelayLine {
 public:
  explicit DelayLine(double delay = 0.0) : delay_(delay) {}
  void reset(double value);
  double step(double value, double step);

 private:
  static constexpr std::size_t kSamples = 512;  ///< half a second at 1 kHz; of more the oldest are forgotten
  double delay_;
  double time_ = 0.0;
  std::array<double, kSamples> times_ = {}, values_ = {};
  std::size_t newest_ = 0, count_ = 0;
};

/// A platform that follows commands as a real one does: each leg, or each axis of a platform without legs, is led
/// within its own stroke, rate and acceleration (`AxisGuard`), follows as a second-order system behind a delay, and
/// comes to rest where the platform was measured to. Nothing is allocated or thrown after construction; a copy saves
/// the state.
class PlatformSimulator {
 public:
  /// @throws InputError as `Platform::validate`.
  explicit PlatformSimulator(const Platform& platform);

  PlatformState reset(const PlatformState& ordered);
  PlatformState step(const PlatformState& ordered, double step);
  /// Where it is.
  [[nodiscard]] const PlatformState& state() const { return state_; }
  /// Where its legs are against neutral [m]; none of a platform without.
  [[nodiscard]] const Legs::Values& leg_positions() const { return leg_positions_; }
  /// How fast they move [m/s].
  [[nodiscard]] const Legs::Values& leg_rates() const { return leg_rates_; }

 private:
  /// What moves one leg or one axis.
  struct Actuator {
    std::optional<AxisGuard> guard;
    DelayLine delay;
    std::array<numerics::CausalFilter, 3> follows;  ///< position, rate, acceleration
    bool at_once = false;
    AxisState last = {};
    AxisState reset(double ordered);
    AxisState step(const AxisState& ordered, double step);
  };
  [[nodiscard]] Actuator actuator(const ActuatorOptions& options) const;
  PlatformState act(const PlatformState& ordered, std::optional<double> step);
  static PlatformState act_on_axes(std::vector<Actuator>& axes, const PlatformState& ordered,
                                   std::optional<double> step);
  PlatformState act_on_legs(const PlatformState& ordered, std::optional<double> step);
  [[nodiscard]] PlatformState at_rest_places(const PlatformState& s) const;

  Platform platform_;
  std::optional<Legs> legs_;
  std::vector<Actuator> actuators_;  ///< of the legs, else of the axes
  std::vector<Actuator> axes_;       ///< of a platform on legs whose axes were measured: they lead the legs
  PlatformState state_, before_reach_;
  Legs::Values leg_positions_, leg_rates_;
};

}  // namespace veridyn::cueing
