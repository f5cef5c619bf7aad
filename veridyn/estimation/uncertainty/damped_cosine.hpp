#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"

namespace veridyn::estimation {

/// How a fit of a decaying oscillation ended.
enum class DampedCosineEnd {
  kFitted,         ///< the step fell below 1e-10 of the frequency's resolution
  kTooFewSamples,  ///< fewer than 20 finite samples, or no time passes
  kNoOscillation,  ///< fewer than three cycles, or less than half of the variance is explained
  kNoConvergence   ///< 100 iterations
};
[[nodiscard]] const char* to_string(DampedCosineEnd end);

/// y(t) = e^(-s t) (a cos(w t) + b sin(w t)) + c, t from the first sample: what a linear oscillator with viscous
/// damping does after it is let go.
struct DampedCosine {
  DampedCosineEnd end = DampedCosineEnd::kTooFewSamples;
  double damped_frequency = kNaN;  ///< w [rad/s]
  double decay = 0.0;              ///< s [1/s]
  double cosine = 0.0;             ///< a
  double sine = 0.0;               ///< b
  double offset = 0.0;             ///< c
  double start = 0.0;              ///< stamp of t = 0
  double duration = 0.0;           ///< of the record [s]
  double sigma_frequency = 0.0;    ///< of w, from the residual with its autocorrelation
  double residual_rms = 0.0;       ///< unit of y
  double r_squared = 0.0;          ///< 1 - residual power / variance of y
  double mean_square_swing = 0.0;  ///< mean of e^(-2 s t) (a^2 + b^2) over the record, unit of y squared

  /// sqrt(w^2 + s^2): of the same oscillator without damping [rad/s].
  [[nodiscard]] double undamped_frequency() const;
  [[nodiscard]] double cycles() const;
  /// Of the envelope, at the first sample.
  [[nodiscard]] double amplitude() const;
  [[nodiscard]] double operator()(double t) const;
  [[nodiscard]] bool usable() const { return end == DampedCosineEnd::kFitted; }
};

/// Fits by Levenberg-Marquardt with analytic derivatives from the peak of the spectrum of the (possibly uneven)
/// samples. Samples that are not finite are left out. Stamps ascend.
[[nodiscard]] DampedCosine fit_damped_cosine(std::span<const double> time, std::span<const double> value);

}  // namespace veridyn::estimation
