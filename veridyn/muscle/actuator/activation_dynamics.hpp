#pragma once

#include <cmath>

namespace veridyn::muscle {

/// Rate of activation [1/s] of OpenSim's Thelen2003 and Millard2012 muscles: (u - a)/tau with tau = tau_act (0.5 + 1.5
/// a) while u > a, else tau_deact/(0.5 + 1.5 a), where a is first brought into [minimum, 1].
///
/// u: excitation, not limited; time constants [s]. The slope jumps at u = a. Check: 10 ms, 40 ms, u = 1, a = 0.1 gives
/// 138.461538462.
template <typename Scalar>
[[nodiscard]] Scalar activation_rate(const Scalar& u, const Scalar& a, const Scalar& activation_time,
                                     const Scalar& deactivation_time) {
  const Scalar factor = Scalar(0.5) + Scalar(1.5) * a;
  return u > a ? (u - a) / (activation_time * factor) : (u - a) * factor / deactivation_time;
}

/// The form of OpenSim <= 2: constant time constants.
template <typename Scalar>
[[nodiscard]] Scalar constant_activation_rate(const Scalar& u, const Scalar& a, const Scalar& activation_time,
                                              const Scalar& deactivation_time) {
  return (u - a) / (u > a ? activation_time : deactivation_time);
}

/// De Groote et al. (2016): the two time constants blended by tanh(smoothing (u - a)), infinitely differentiable.
///
/// OpenSim's smoothing of 0.1 blends them almost equally, 10 separates them. Check: 15 ms, 60 ms, u = 1, a = 0.1
/// gives 54.7339439415 with 0.1, 92.3076910503 with 10.
template <typename Scalar>
[[nodiscard]] Scalar smooth_activation_rate(const Scalar& u, const Scalar& a, const Scalar& activation_time,
                                            const Scalar& deactivation_time, double smoothing) {
  using std::tanh;
  const Scalar f = Scalar(0.5) * tanh(Scalar(smoothing) * (u - a));
  const Scalar z = Scalar(0.5) + Scalar(1.5) * a;
  return ((f + Scalar(0.5)) / (activation_time * z) + (Scalar(0.5) - f) * z / deactivation_time) * (u - a);
}

}  // namespace veridyn::muscle
