#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

/// Where in a step a stage of the classical Runge-Kutta method lies.
enum class RungeKuttaMoment { kMiddle, kEnd };

/// The rest of a step of length `h` of the classical fourth-order Runge-Kutta method, whose rate at the beginning,
/// `k1`, is known: `rate(moment, x)` returns the others. Works on what `runge_kutta_4_step` works on.
template <typename State, typename Scalar, typename Rate>
[[nodiscard]] State runge_kutta_4_from(const State& k1, const Rate& rate, const State& x, const Scalar& h) {
  const Scalar half = h * Scalar(0.5);
  const State k2 = rate(RungeKuttaMoment::kMiddle, State(x + half * k1));
  const State k3 = rate(RungeKuttaMoment::kMiddle, State(x + half * k2));
  const State k4 = rate(RungeKuttaMoment::kEnd, State(x + h * k3));
  return x + (h * Scalar(1.0 / 6.0)) * (k1 + Scalar(2.0) * (k2 + k3) + k4);
}

/// The same in place, for large states in hot loops: `rate(moment, at)` returns a reference to the rate at the stage
/// `at`, which it may still correct, and only the first `kMoving` entries of the fixed-size Eigen vectors move. The sum
/// is taken in the order of the stages, so that rounding differs from that of `runge_kutta_4_from`.
template <int kMoving, typename State, typename Rate>
void runge_kutta_4_in_place(const State& k1, Rate&& rate, double h, State& x) {
  // Plain loops, which compilers vectorise everywhere.
  const auto each = [](const auto& set) {
    for (Eigen::Index i = 0; i < kMoving; ++i) set(i);
  };
  State at = x, sum;
  each([&](Eigen::Index i) { at.data()[i] = x.data()[i] + 0.5 * h * k1.data()[i]; });
  const State& k2 = rate(RungeKuttaMoment::kMiddle, at);
  each([&](Eigen::Index i) {
    sum.data()[i] = k1.data()[i] + 2.0 * k2.data()[i];
    at.data()[i] = x.data()[i] + 0.5 * h * k2.data()[i];
  });
  const State& k3 = rate(RungeKuttaMoment::kMiddle, at);
  each([&](Eigen::Index i) {
    sum.data()[i] += 2.0 * k3.data()[i];
    at.data()[i] = x.data()[i] + h * k3.data()[i];
  });
  const State& k4 = rate(RungeKuttaMoment::kEnd, at);
  each([&](Eigen::Index i) { x.data()[i] += h / 6.0 * (sum.data()[i] + k4.data()[i]); });
}

/// One step of the classical fourth-order Runge-Kutta method for x' = f(t, x).
///
/// `State` is anything with sums and products by a scalar (Eigen vectors of double or Jet); `derivative(t, x)` returns
/// a State. Neither throws nor allocates beyond what `derivative` does. Local error O(h^5), global O(h^4).
template <typename State, typename Scalar, typename Derivative>
[[nodiscard]] State runge_kutta_4_step(const Derivative& derivative, const Scalar& t, const State& x, const Scalar& h) {
  const Scalar middle = t + h * Scalar(0.5), end = t + h;
  const State k1 = derivative(t, x);
  const auto rate = [&](RungeKuttaMoment moment, const State& at) -> State {
    return derivative(moment == RungeKuttaMoment::kMiddle ? middle : end, at);
  };
  return runge_kutta_4_from(k1, rate, x, h);
}

/// How an adaptive integration ended.
enum class IntegrationEnd {
  kReached,    ///< at the wanted time
  kStepLimit,  ///< `max_steps` were used up first
  kStepSize,   ///< the error stayed too large at a step below 1e-14 of the interval
  kNotFinite,  ///< the state or its derivative became NaN or infinite
};

}  // namespace veridyn::numerics
