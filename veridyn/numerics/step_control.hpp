#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "veridyn/numerics/ode.hpp"

namespace veridyn::numerics {

/// How an error-controlled integration chooses its steps.
struct StepControl {
  double tolerance = 1e-6;  ///< largest error of a step in any component, as a part of the component's scale
  /// With Jets or tangents: the same of their derivatives, as a part of the largest of each (scaled). They need it:
  /// where a stiff solution rests, steps grow until its errors show, and those of a derivative would have grown unseen
  /// meanwhile.
  double derivative_tolerance = 1e-4;
  /// Derivatives whose largest (scaled) is below this count as that large. One that is zero until an input or a branch
  /// begins to act is wrong by all of itself in the step in which that happens, however short it is.
  double least_derivative = 0.0;
  double first_step = 0.0;     ///< 0: chosen from the first derivative
  double smallest_step = 0.0;  ///< 0: 1e-13 of the interval
  double largest_step = 0.0;   ///< 0: the interval
  long max_steps = 1000000;    ///< accepted and rejected, of this object
};

namespace internal {
inline double value_of(double x) { return x; }
template <typename Jet>
auto value_of(const Jet& x) -> decltype(x.a) {
  return x.a;
}
}  // namespace internal

/// A step to begin with: a tenth of that in which the fastest component changes by its value (or its scale), shorter
/// the smaller the tolerance. @param exponent 1 over the order of the error of a step
template <typename Scalar>
double first_step(const Scalar* x, const Scalar* rate, std::span<const double> scale, double tolerance, double exponent,
                  double interval) {
  double size = 0.0, fastest = 0.0;
  for (std::size_t i = 0; i < scale.size(); ++i) {
    size = std::max(size, std::abs(internal::value_of(x[i])) / scale[i]);
    fastest = std::max(fastest, std::abs(internal::value_of(rate[i])) / scale[i]);
  }
  const double h =
      fastest > 0.0 ? 0.1 * std::pow(tolerance, exponent) * std::max(size, 1.0) / fastest : 1e-3 * interval;
  return std::min(h, interval);
}

/// The step sizes of an integration: PI control (Gustafsson 1991) by an error estimate, for any one-step method.
class StepSizes {
 public:
  /// `exponent`: 1 over the order of the error of a step; `beta` of the last error.
  StepSizes(double exponent, double beta) : exponent_(exponent - 0.75 * beta), beta_(beta) {}

  /// The derivative jumps here: the method's `begin` is called again. `keep_step` keeps the size of the next step.
  void restart(bool keep_step) {
    fresh_ = true;
    if (!keep_step) step_ = 0.0;
    last_error_ = kSmallError;
  }
  /// Accepted and rejected steps so far.
  [[nodiscard]] long steps() const { return steps_; }
  /// Of the next step.
  [[nodiscard]] double step_size() const { return step_; }

  /// Steps from `t` to `end` > t. `begin()` evaluates the derivative at t, false: there is none; `guess(interval)` is a
  /// first step; `attempt(h)` computes a step, false: it leads nowhere, and is tried again at a quarter; `error()` of
  /// that step, above 1: too large; `accept(reached)` takes it, moves t there and returns false to stop.
  template <typename Begin, typename Guess, typename Attempt, typename Error, typename Accept>
  IntegrationEnd advance(const double& t, double end, const StepControl& control, const Begin& begin,
                         const Guess& guess, const Attempt& attempt, const Error& error, const Accept& accept) {
    const double interval = end - t;
    if (interval == 0.0) return IntegrationEnd::kReached;
    const double smallest = control.smallest_step > 0.0 ? control.smallest_step : 1e-13 * interval;
    const double largest = control.largest_step > 0.0 ? control.largest_step : interval;
    if (fresh_) {
      if (!begin()) return IntegrationEnd::kNotFinite;
      fresh_ = false;
      if (step_ <= 0.0) step_ = control.first_step > 0.0 ? control.first_step : guess(interval);
    }
    while (t < end) {
      if (steps_++ >= control.max_steps) return IntegrationEnd::kStepLimit;
      double h = std::min(step_, largest);
      const bool last = t + 1.0001 * h >= end;  // a hair too short makes a useless last step
      if (last) h = end - t;
      if (!attempt(h)) {
        if (h <= smallest) return IntegrationEnd::kNotFinite;
        step_ = 0.25 * h;
        continue;
      }
      const double e = error();
      const double power = std::pow(std::max(e, 1e-10), exponent_);
      if (!(e <= 1.0)) {
        if (h <= smallest) return IntegrationEnd::kStepSize;
        step_ = h / std::min(5.0, std::isfinite(power) ? power / 0.9 : 5.0);
        continue;
      }
      const double factor = std::clamp(power / std::pow(last_error_, beta_) / 0.9, 0.1, 5.0);
      last_error_ = std::max(e, kSmallError);
      const double next = h / factor;
      // A step cut short by the end says little about the next one.
      step_ = last ? std::max(step_, next) : next;
      if (!accept(last ? end : t + h)) return IntegrationEnd::kReached;
    }
    return IntegrationEnd::kReached;
  }

 private:
  static constexpr double kSmallError = 1e-4;
  double exponent_, beta_;
  double step_ = 0.0;
  double last_error_ = kSmallError;
  long steps_ = 0;
  bool fresh_ = true;
};

}  // namespace veridyn::numerics
