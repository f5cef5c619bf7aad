#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/options/identify_options.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/regression/group_scatter.hpp"
#include "veridyn/estimation/result/analysis.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {

/// How well a coefficient is predicted in one of several flights.
struct FlightFit {
  std::string flight;
  numerics::FitMeasures fit = {};
};

/// Figures by which the estimate of a coefficient is judged; see CoefficientResult.
struct CoefficientChecks {
  numerics::FitMeasures identification_fit, holdout_fit;
  std::vector<FlightFit> flight_fits;  ///< of several flights, on the hold-out of each
  double error_ratio = 0.0;
  double holdout_ratio = 0.0;  ///< residual variance on the hold-out over what the sensors' errors leave there
  double unmodelled_share = 0.0;
  double contradiction_p = 1.0;  ///< NaN: the hold-out by itself gives no estimate
  /// Share of the hold-out outside the band of 95 % that the residual of the identification part gives.
  double outside_bands = 0.0;
  /// Root mean square error on the hold-out over that of the values that the study started from; NaN without these.
  double error_over_start = kNaN;
  double scatter = 1.0;  ///< chi-square of the flight's parts over its degrees of freedom
  bool has_holdout = false;
  numerics::Autocorrelation residual_autocorrelation;
};

/// The rows of one estimated coefficient: choice of the method, residual beyond the sensors, hold-out, its bands there,
/// start values there, agreement of the flight's parts, and the checks of the comparison of methods.
[[nodiscard]] std::vector<estimation::Evidence> coefficient_evidence(const std::string& name,
                                                                     const CoefficientChecks& checks,
                                                                     const estimation::RegressionComparison& comparison,
                                                                     const IdentifyOptions& options);

/// The row "scatter between flights": do several flights have the same parameters within their error bars (Cochran's
/// Q)? With care where they have not: the intervals of `chosen` are then those of the mean of flights like these, from
/// the scatter. Not verified where no two flights determine the parameters by themselves.
[[nodiscard]] estimation::Evidence scatter_row(const std::string& name, const estimation::GroupScatter& scatter,
                                               const estimation::RegressionEstimate& chosen);

/// Are the values those of an aircraft? Lift slope against lifting-line theory of the subject's wing (Helmbold's
/// formula, within a factor of 2), signs of damping, side force and drag: with care where a value contradicts them by
/// more than three standard errors, since a wrong sign, unit or scale of a sensor is then more likely than such an
/// aircraft; a sign that is not determined is not verified.
[[nodiscard]] std::vector<estimation::Evidence> plausibility(Coefficient coefficient,
                                                             std::span<const estimation::Parameter> parameters,
                                                             const Subject& subject);

}  // namespace veridyn::aircraft
