#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

namespace veridyn::numerics {

/// One step of the classical fourth-order Runge-Kutta method for x' = f(t, x).
///
/// `State` is anything with sums and products by a scalar (Eigen vectors of double or Jet); `derivative(t, x)` returns
/// a State. Neither throws nor allocates beyond what `derivative` does. Local error O(h^5), global O(h^4).
template <typename State, typename Scalar, typename Derivative>
[[nodiscard]] State runge_kutta_4_step(const Derivative& derivative, const Scalar& t, const State& x, const Scalar& h) {
  const Scalar half = h * Scalar(0.5);
  const State k1 = derivative(t, x);
  const State k2 = derivative(Scalar(t + half), State(x + half * k1));
  const State k3 = derivative(Scalar(t + half), State(x + half * k2));
  const State k4 = derivative(Scalar(t + h), State(x + h * k3));
  return x + (h * Scalar(1.0 / 6.0)) * (k1 + Scalar(2.0) * (k2 + k3) + k4);
}

/// How an adaptive integration ended.
enum class IntegrationEnd {
  kReached,    ///< at the wanted time
  kStepLimit,  ///< `max_steps` were used up first
  kStepSize,   ///< the error stayed too large at a step below 1e-14 of the interval
  kNotFinite,  ///< the state or its derivative became NaN or infinite
};

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
  [[nodiscard]] std::string message() const;
};

/// x' = f(t, x), written into `rate`, which has the size of `x`.
using OdeFunction = std::function<void(double t, const Eigen::VectorXd& x, Eigen::VectorXd& rate)>;

/// Integrates from `begin` to `end` (either direction) with the fifth-order method of Dormand & Prince (1980), its
/// step controlled by the embedded fourth-order error estimate (Boost.odeint). `observe(t, x)`, when given, is called
/// at the start and after each accepted step.
[[nodiscard]] IntegrationResult integrate_adaptive(
    const OdeFunction& function, const Eigen::VectorXd& start, double begin, double end,
    const IntegrationOptions& options = {},
    const std::function<void(double, const Eigen::VectorXd&)>& observe = nullptr);

}  // namespace veridyn::numerics
