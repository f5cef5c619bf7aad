#pragma once

#include <Eigen/Core>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::estimation {

/// How large the errors of residuals z - y = nu + sum_j f_j H_j c_j are, nu ~ N(0, sigma^2) by output, c_j ~ N(0, I).
struct InputErrorSizes {
  Eigen::VectorXd noise;    ///< sigma, by output
  Eigen::VectorXd factors;  ///< f, by kind of error j
};

/// What is known of the sizes beforehand.
struct InputErrorSizesOptions {
  bool noise = true;    ///< look for the noise of the outputs; else it stays where it begins
  bool factors = true;  ///< look for the factors; else they stay
  /// A factor's square is as if it had been measured as 1 by so many errors.
  double prior_errors = 4.0;
  int iterations = 12;
};

/// Residuals of a segment and its responses H to errors, (samples outputs) x errors as in `ErrorWhitening`.
struct ErrorResponse {
  RowMatrix residual;             ///< samples x outputs, NaN: not measured
  RowMatrix response;             ///< H of all kinds
  std::vector<int> kind_of = {};  ///< by column of H: j
};

/// The likeliest sizes with inverse-gamma priors of f^2 about 1: each iteration multiplies a variance by
/// sqrt(r'R^-1 K R^-1 r/tr(R^-1 K)), K its share of R (minorise and maximise: Zhou, Hu, Zhou & Lange 2019, J. Comput.
/// Graph. Stat. 28:350), beginning at `sizes`. Samples are taken in blocks of some hundred as if independent of other
/// blocks, which loses little where an error is shorter than a block, and costs samples x block^2.
[[nodiscard]] InputErrorSizes find_input_error_sizes(const std::vector<ErrorResponse>& segments, InputErrorSizes sizes,
                                                     const InputErrorSizesOptions& options);

}  // namespace veridyn::estimation
