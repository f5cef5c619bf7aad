#pragma once

#include <span>
#include <string>
#include <string_view>

namespace veridyn::estimation {

/// What may be said of one parameter. `to_string` gives the words of estimate.json.
enum class ParameterStatus {
  kIdentified,     ///< differs from zero at the chosen significance
  kInsignificant,  ///< determined, but zero lies inside its interval: marked, not zeroed
  kWeak,           ///< differs from zero, but its interval is wide: see kWeakShare
  kEffective,      ///< predicts, but is no physical constant: the model lacks something that it makes up for
  kImplausible,    ///< determined, but no individual of this kind has such a value
  kAtBound,        ///< its search ended at the limit of what was allowed: neither value nor error bar are the data's
  kNotExcited,     ///< the data do not determine it; its error bar is the bound on what is not excited
  kRejected,       ///< the estimate as a whole must not be used
  kFixed           ///< pinned by the user
};
[[nodiscard]] std::string_view to_string(ParameterStatus status);

/// Half the width of the interval of 95 % over the value, beyond which what is identified is `weak`.
inline constexpr double kWeakShare = 0.5;

/// One estimated parameter, whichever method estimated it and whatever it belongs to: in results of estimators, in
/// `Estimate` and so in estimate.json, in tables of the report.
struct Parameter {
  std::string name;  ///< as in the literature: `CL_alpha`
  double value = 0.0;
  double sigma = 0.0;  ///< of the chosen covariance
  double low95 = 0.0;  ///< Student's t with the estimate's degrees of freedom
  double high95 = 0.0;
  std::string unit = "1";
  ParameterStatus status = ParameterStatus::kRejected;
  // What estimators say of it beyond estimate.json; a parameter read from a file has the defaults.
  double t = 0.0;        ///< value / sigma
  double p_value = 1.0;  ///< two-sided, of "the parameter is zero"
  double sigma_white = 0.0;
  /// Variance inflation factor 1/(1 - R^2 of this column on the others): above about 10 the column is nearly a
  /// combination of the others. 1 for a constant column alone.
  double variance_inflation = 1.0;
  /// Share (0..1) of the parameter's unit vector that lies in directions that were not excited.
  double unexcited_share = 0.0;
};

/// The parameter of this name; null where there is none.
[[nodiscard]] const Parameter* find_parameter(std::span<const Parameter> parameters, std::string_view name);

/// Sets interval, t and p_value from value and sigma, by Student's t with `degrees_of_freedom`. What is fixed has no
/// test: its p_value is NaN.
void set_interval(Parameter& parameter, double degrees_of_freedom);

/// Widens the interval by a factor on the variance (1 or less changes nothing); what is then no longer distinguishable
/// from zero at the level `significance` becomes insignificant.
void widen(Parameter& parameter, double variance_factor, double degrees_of_freedom, double significance);

}  // namespace veridyn::estimation
