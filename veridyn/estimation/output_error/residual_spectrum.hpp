#pragma once

#include <Eigen/Core>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::estimation {

/// Auto- and cross-covariance of several residuals over lags, as a spectrum, for the covariance of estimators whose
/// residuals are autocorrelated.
struct ResidualSpectrum {
  Eigen::Index window = 0;  ///< lags that count in full; weights fall to 0 at twice that [samples]
  Eigen::Index length = 0;  ///< of the Fourier transforms: longest segment and twice the window, zero padded
  std::vector<Eigen::MatrixXcd> density;  ///< outputs x outputs at each of length/2 + 1 frequencies, positive definite
  double degrees_of_freedom = 0.0;        ///< samples over the sum of squared lag weights
  double kept = 1.0;  ///< share of the variance that residuals of an estimate still show: 1 - sum of weights / samples
};

/// From residuals of unit variance (samples x outputs per segment; NaN where missing). The window is the longest
/// correlation length (`correlation_length`) of any output. Directions whose density is below 0.05 are raised to it.
[[nodiscard]] ResidualSpectrum residual_spectrum(const std::vector<RowMatrix>& residuals, Eigen::Index max_lag);

/// sum over i, j of S_i' Gamma(i - j) S_j for one segment, by Parseval: `sensitivity` has a row per sample and output
/// (k outputs + j), zero where missing.
[[nodiscard]] Eigen::MatrixXd autocorrelated_information(const ResidualSpectrum& spectrum, const RowMatrix& sensitivity,
                                                         Eigen::Index outputs);

}  // namespace veridyn::estimation
