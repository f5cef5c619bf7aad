#include "veridyn/aircraft/identification/parameter_groups.hpp"

#include <algorithm>
#include <optional>

#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::MethodResult;
using estimation::Parameter;
using estimation::ParameterGroup;

MethodResult& method_of(ParameterGroup& group, const std::string& method) {
  const auto found = std::ranges::find(group.methods, method, &MethodResult::method);
  if (found != group.methods.end()) return *found;
  group.methods.push_back({.method = method, .usable = true});
  return group.methods.back();
}

ParameterGroup group_of(const CoefficientResult& result, const OtherEstimators& others) {
  ParameterGroup group{.name = result.name,
                       .meaning = std::string(meaning_of(result.coefficient)),
                       .verdict = result.verdict,
                       .reason = result.reason,
                       .evidence = result.evidence,
                       .judgement = result.judgement};
  for (const estimation::RegressionEstimate& e : result.comparison.estimates)
    group.methods.push_back({std::string(to_string(e.method)), e.usable(), e.message, e.parameters});
  if (result.chosen) {
    group.method = result.method;
    group.parameters = result.chosen->parameters;
  }
  const bool by_output_error = result.output_error_widening.size() > 0;
  for (const AxisOutputError& run : others.output_error) {
    if (!by_output_error || run.axis != result.axis) continue;
    for (const Parameter& p : run.estimate.parameters)
      if (result.chosen->find(p.name) != nullptr) method_of(group, result.method).parameters.push_back(p);
  }
  for (const OtherParameter& other : others.parameters) {
    // The regression that it started from is there already.
    const bool listed = by_output_error && to_string(result.chosen->method) == other.estimate.method;
    if (other.coefficient == result.coefficient && !listed)
      method_of(group, other.estimate.method).parameters.push_back(other.estimate.parameter);
  }
  return group;
}

}  // namespace

std::vector<ParameterGroup> parameter_groups(std::span<const CoefficientResult> results,
                                             const OtherEstimators& others) {
  std::vector<ParameterGroup> groups;
  for (const CoefficientResult& result : results) groups.push_back(group_of(result, others));
  return groups;
}

std::map<std::string, double, std::less<>> true_values(const Subject& truth, const Subject& subject,
                                                       std::span<const CoefficientResult> results) {
  std::map<std::string, double, std::less<>> values;
  for (const CoefficientResult& result : results) {
    const CoefficientModel* model = truth.model.find(result.coefficient);
    if (model == nullptr) continue;
    for (const Term& term : result.model.terms) {
      if (const std::optional<double> value = model->value_of(term.expression))
        values[regressed_parameter_name(result.coefficient, term, subject)] = *value;
    }
  }
  return values;
}

std::vector<estimation::PredictedQuantity> predictions(std::span<const PredictedQuantity> simulated,
                                                       std::span<const CoefficientResult> results) {
  std::vector<estimation::PredictedQuantity> all;
  for (const PredictedQuantity& q : simulated) all.push_back({q.name, q.unit, q.fit, kNaN});
  for (const CoefficientResult& result : results) {
    if (result.holdout_fit.count > 0) all.push_back({result.name, "1", result.holdout_fit, kNaN});
  }
  return all;
}

}  // namespace veridyn::aircraft
