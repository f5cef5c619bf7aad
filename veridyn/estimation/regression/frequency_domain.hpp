#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::estimation {

/// Finite Fourier transform: integral over [0, (N-1) step] of x(t) exp(-j 2 pi f t) dt at any frequencies, by direct
/// sums of the cubic interpolant through the samples (Filon's idea; Press et al., Numerical Recipes, 13.9): exact for
/// cubic polynomials at any frequency, error O(step^4) otherwise. Needs at least 8 samples; f up to 1/(2 step).
[[nodiscard]] Eigen::VectorXcd finite_fourier_transform(std::span<const double> x, double step,
                                                        std::span<const double> frequencies_Hz);

/// The band of a regression in the frequency domain.
struct FrequencyOptions {
  double low_Hz = 0.1;         ///< below lie biases, drifts and trim
  double high_Hz = 2.0;        ///< above lies no rigid-body motion, only noise
  double resolution_Hz = 0.0;  ///< spacing; 0 takes 1/duration of each segment, at which values are independent
  bool remove_trend = true;    ///< subtract a straight line from every column of a segment first
  double significance = 0.05;
  CovarianceKind covariance = CovarianceKind::kAutocorrelated;

  /// @throws InputError unless 0 < low < high <= 1/(2 step).
  void validate(double step) const;
};

/// Equation error in the frequency domain.
struct FrequencyEstimate {
  RegressionEstimate estimate;   ///< of the parameters that the band determines; `rows` counts real and imaginary parts
  Eigen::Index frequencies = 0;  ///< complex values over all segments
  Eigen::Index segments = 0;     ///< long enough to hold a frequency of the band
  std::vector<std::string> left_out;  ///< parameters of constant regressors, which have no content in the band
};

/// z = X theta in the frequency domain (Morelli & Klein; Klein & Morelli 2006, chapter 7): columns of `data` sampled
/// every `step` seconds are transformed segment by segment at frequencies of the band, and theta minimises
/// sum |z(f) - x(f) theta|^2 over them, theta real.
///
/// Constant regressors and whatever is a straight line in a segment vanish, so biases and drifts of the sensors need no
/// parameters; noise outside the band does no harm. Values of a segment are divided by sqrt(duration): then the noise
/// of long and short segments weighs the same. Covariance: kWhite: s^2 [Re(X'X)]^-1 with s^2 from 2 M - n real values;
/// kAutocorrelated: residual power may vary over frequency (sandwich with leverage correction HC3), which is what
/// autocorrelated residuals are here, so no lags are needed. Errors in the regressors within the band still bias, as in
/// OLS.
/// @throws InputError when data, step or options are wrong. With no usable frequency: `kTooFewRows`.
[[nodiscard]] FrequencyEstimate frequency_equation_error(const RegressionData& data, double step,
                                                         const FrequencyOptions& options = {});

}  // namespace veridyn::estimation
