#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/flight_signals.hpp"
#include "veridyn/aircraft/identification/identification.hpp"
#include "veridyn/aircraft/identification/segments.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/estimate.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"

namespace veridyn::aircraft {

/// Output error on the segments of one axis.
struct AxisOutputError {
  Axis axis = Axis::kLongitudinal;
  std::vector<Coefficient> coefficients;  ///< whose parameters were estimated together
  bool attempted = false;
  estimation::OutputErrorEstimate estimate;
  std::string text;  ///< one sentence: what came out, or why it was not tried
};

/// One parameter by one of the other methods, against the recommended regression.
struct OtherParameter {
  Coefficient coefficient = Coefficient::kCL;
  estimation::MethodEstimate estimate;
  /// (value - regression) / sqrt(sigma^2 + sigma_regression^2); both use the same data, so +-1 is common and +-3 a
  /// contradiction. NaN where either has no error bar.
  double normalised_difference = 0.0;
};

/// The same parameters by estimators other than regression, on the same identification segments.
struct OtherEstimators {
  std::vector<AxisOutputError> output_error;
  std::vector<OtherParameter> parameters;
  std::vector<std::string> notes;  ///< one sentence per method and coefficient
  [[nodiscard]] bool empty() const { return parameters.empty() && notes.empty(); }
};

/// Runs the estimators that `options` names: output error per axis, started at the chosen regression; frequency-domain
/// equation error and block bootstrap per coefficient. Of several flights output error has one set of parameters and
/// each segment's own initial state (and biases), in its own flight's wind; where parameters differ between flights, no
/// method's error bar is below that of the scatter. Nothing in `results` is changed.
[[nodiscard]] OtherEstimators compare_other_estimators(std::span<const PreparedFlight> flights, const Subject& subject,
                                                       std::span<const CoefficientResult> results,
                                                       const IdentifyOptions& options, Progress& progress);

}  // namespace veridyn::aircraft
