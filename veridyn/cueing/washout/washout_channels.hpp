#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "veridyn/cueing/washout/washout.hpp"
#include "veridyn/numerics/linear_systems/causal_filter.hpp"
#include "veridyn/numerics/ode.hpp"

namespace veridyn::cueing {

/// The forces that a platform renders by roll and by pitch [m/s^2], of a specific force forward, right, down: the
/// right side down brings one to the left, the nose up one forward.
[[nodiscard]] inline Eigen::Vector2d tilted_force(const Eigen::Vector3d& force) { return {-force.y(), force.x()}; }

/// Output of a filter that is begun or fed on.
inline double next(numerics::CausalFilter& filter, double input, SampleStep step) {
  return step ? filter.step(input, *step) : filter.reset(input);
}

/// Where a channel is and what of it is felt.
struct ChannelOutput {
  double place = 0.0;   ///< shift or angle
  double change = 0.0;  ///< acceleration of the shift, or rate of the angle
};

/// The shift that renders the beginnings of an acceleration: it through the high-pass s^2 / (s^2 + 2 zeta w s + w^2)
/// [s / (s + recentre)], twice integrated, in one filter without a pole at zero, so that it cannot drift.
class ShiftChannel {
 public:
  /// @param omega [rad/s] @param recentre [rad/s]; 0: none
  ShiftChannel(double omega, double zeta, double recentre);
  ChannelOutput step(double acceleration, SampleStep step) {
    return {next(place_, acceleration, step), next(change_, acceleration, step)};
  }

 private:
  numerics::CausalFilter place_, change_;
};

/// The angle that renders the beginnings of a turn: the rate through the high-pass of second order, integrated.
class TurnChannel {
 public:
  TurnChannel(double omega, double zeta);
  ChannelOutput step(double rate, SampleStep step) { return {next(place_, rate, step), next(change_, rate, step)}; }

 private:
  numerics::CausalFilter place_, change_;
};

/// Tilt coordination: gravity stands for a lasting force. It goes to asin(force / g), |force / g| being 1 at most, no
/// faster than somebody feels as a turn.
class TiltCoordination {
 public:
  ChannelOutput step(double force, double most_rate, SampleStep step);
  [[nodiscard]] double tilt() const { return tilt_; }

 private:
  double tilt_ = 0.0;
};

/// A state and its inputs over a step during which the inputs go on lines, by the Runge-Kutta method of fourth order on
/// pieces of no more than 5 ms.
/// @param rate the state's derivative, of state and inputs
template <typename State, typename Input, typename Rate>
[[nodiscard]] State integrated(State x, const Input& before, const Input& now, double step, const Rate& rate) {
  constexpr double kLongestPiece = 0.005;
  const double pieces = std::max(1.0, std::ceil(step / kLongestPiece * (1.0 - 1e-9)));
  const double h = step / pieces;
  const auto derivative = [&](double part, const State& at) {
    return State(rate(at, Input(before + part / pieces * (now - before))) * h);
  };
  for (double k = 0.0; k < pieces; ++k) x = numerics::runge_kutta_4_step(derivative, k, x, 1.0);
  return x;
}

/// From one value towards another by no more than `most`.
[[nodiscard]] double step_towards(double from, double to, double most);

}  // namespace veridyn::cueing
