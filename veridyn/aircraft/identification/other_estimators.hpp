#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/identification.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::aircraft {

/// One parameter by one of the other methods, against the chosen one.
struct OtherParameter {
  Coefficient coefficient = Coefficient::kCL;
  estimation::MethodEstimate estimate;
  /// (value - chosen) / sqrt(sigma^2 + sigma_chosen^2); both use the same data, so +-1 is common and +-3 a
  /// contradiction. NaN where either has no error bar.
  double normalised_difference = 0.0;
};

/// The same parameters by estimators other than the chosen one, on the same identification segments.
struct OtherEstimators {
  std::vector<AxisOutputError> output_error;
  std::vector<OtherParameter> parameters;
  std::vector<std::string> notes;  ///< one sentence per method and coefficient
  [[nodiscard]] bool empty() const { return parameters.empty() && notes.empty(); }
};

/// Runs the estimators that `options` names: output error per axis, started at the chosen regression; frequency-domain
/// equation error and block bootstrap per coefficient. Of several flights output error has one set of parameters and
/// each segment's own initial state (and biases), in its own flight's wind; where parameters differ between flights, no
/// method's error bar is below that of the scatter. Where output error is the chosen method, the regression that it
/// started from is compared with it.
[[nodiscard]] OtherEstimators compare_other_estimators(std::span<const PreparedFlight> flights, const Subject& subject,
                                                       const Identification& found, const IdentifyOptions& options,
                                                       Progress& progress);

}  // namespace veridyn::aircraft
