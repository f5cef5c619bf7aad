#pragma once

#include <Eigen/Core>
#include <functional>

#include "veridyn/numerics/ode.hpp"

namespace veridyn::numerics {

/// Accuracy and limits of `integrate_adaptive`.
struct IntegrationOptions {
  double absolute_tolerance = 1e-9;  ///< per step and component, in units of the state
  double relative_tolerance = 1e-9;
  double first_step = 0.0;  ///< [time]; 0: a thousandth of the interval
  long max_steps = 1000000;
};

/// Where an integration ended, and how.
struct IntegrationResult {
  Eigen::VectorXd state;  ///< where it ended
  double time = 0.0;
  long steps = 0;
  IntegrationEnd end = IntegrationEnd::kReached;
  [[nodiscard]] bool usable() const { return end == IntegrationEnd::kReached; }
};

/// x' = f(t, x), written into `rate`, which has the size of `x`.
using OdeFunction = std::function<void(double t, const Eigen::VectorXd& x, Eigen::VectorXd& rate)>;

/// Integrates from `begin` to `end` (either direction) with the fifth-order method of Dormand & Prince (1980), its
/// step controlled by the embedded fourth-order error estimate: Boost.odeint, which shares no code with ours.
/// `observe(t, x)`, when given, is called at the start and after each accepted step.
[[nodiscard]] IntegrationResult integrate_adaptive(
    const OdeFunction& function, const Eigen::VectorXd& start, double begin, double end,
    const IntegrationOptions& options = {},
    const std::function<void(double, const Eigen::VectorXd&)>& observe = nullptr);

}  // namespace veridyn::numerics
