#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/judgement/judgement.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/estimation/result/parameter.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {

/// What may be said of parameters that were estimated together.
enum class GroupVerdict {
  kIdentified,  ///< physical constants within their intervals; single parameters may still be insignificant
  kEffective,   ///< predicts the hold-out, but the values are no physical constants
  kNotExcited,  ///< the recording does not move what they depend on
  kRejected,    ///< an estimate exists and must not be used
  kSkipped      ///< something that it needs is missing
};
/// "identified", "effective", "not excited", "rejected", "skipped".
[[nodiscard]] std::string_view to_string(GroupVerdict verdict);
/// Whether there are values that a simulation may use.
[[nodiscard]] constexpr bool usable(GroupVerdict verdict) {
  return verdict == GroupVerdict::kIdentified || verdict == GroupVerdict::kEffective;
}
/// What the grades of a group with an estimate amount to: identified where its parameters may be used, effective where
/// it only predicts, else rejected.
[[nodiscard]] GroupVerdict verdict_of(const Judgement& judgement);

/// The parameters of a group as its verdict marks them: what is neither fixed nor unexcited becomes rejected with the
/// group, or effective where nothing worse is known of it (implausible, at its bound); of an identified group what has
/// a wide interval becomes weak.
[[nodiscard]] std::vector<Parameter> marked(std::vector<Parameter> parameters, GroupVerdict verdict);

/// The parameters with `status` for those that a row is about which did not pass; what is fixed or not excited stays.
[[nodiscard]] std::vector<Parameter> marked(std::vector<Parameter> parameters, std::span<const Evidence> rows,
                                            ParameterStatus status);

/// Parameters by one method.
struct MethodResult {
  std::string method = {};  ///< "GTLS", "output error"
  bool usable = false;
  std::string message = {};  ///< one sentence: what came out, or why nothing did
  std::vector<Parameter> parameters = {};

  [[nodiscard]] const Parameter* find(std::string_view name) const;
};

/// Parameters that are estimated and judged together: a coefficient of an aircraft, a whole vehicle.
struct ParameterGroup {
  std::string name = {};     ///< "Cm", or the vehicle's
  std::string meaning = {};  ///< in plain words: "pitching moment"; may be empty
  GroupVerdict verdict = GroupVerdict::kSkipped;
  std::string reason = {};  ///< one sentence
  /// The result: the chosen method's, with what is not known of mass and geometry in the error bars too. Empty where no
  /// method gave any.
  std::vector<Parameter> parameters = {};
  std::string method = {};                 ///< the chosen one; empty: none
  std::vector<MethodResult> methods = {};  ///< all that were tried, on equal terms: errors of the recording only
  std::vector<Evidence> evidence = {};     ///< that bears on this group, of the recording too
  Judgement judgement = {};                ///< `judge(evidence)`
};

/// A quantity that the identified model predicts, on data that identification did not see.
struct PredictedQuantity {
  std::string name = {};  ///< "airspeed", "yaw_rate", "Cm"
  std::string unit = "1";
  numerics::FitMeasures fit = {};
  double lag1 = 0.0;  ///< autocorrelation of the residual at one sample, 0 when it is white; NaN: not computed
  /// Variance of the mean of many residuals over that of as many independent ones; NaN: not computed.
  double long_run = kNaN;
};

/// The file form of a domain with one group: the group as it is, what the methods that were not chosen gave, and the
/// predictions. Fit, warnings and structure are the domain's. @param covariance of the group's parameters
[[nodiscard]] Estimate estimate_of(const ParameterGroup& group, Eigen::MatrixXd covariance,
                                   std::span<const PredictedQuantity> predictions);

/// What identification delivers, whatever the domain: read by estimate.json, tables, console and report. What only one
/// domain has (its signals, its figures) stays in the domain's type, which holds one of these.
struct Analysis {
  Estimate estimate = {};
  std::vector<ParameterGroup> groups = {};
  std::vector<PredictedQuantity> predictions = {};
  std::map<std::string, double, std::less<>> truth = {};  ///< of a simulated recording, by parameter; empty otherwise
  bool interrupted = false;                               ///< then the rest is as far as it got

  /// NaN where the truth is not known.
  [[nodiscard]] double true_value(std::string_view parameter) const;
};

}  // namespace veridyn::estimation
