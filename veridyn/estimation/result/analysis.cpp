#include "veridyn/estimation/result/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"

namespace veridyn::estimation {

std::string_view to_string(GroupVerdict verdict) {
  switch (verdict) {
    case GroupVerdict::kIdentified:
      return "identified";
    case GroupVerdict::kEffective:
      return "effective";
    case GroupVerdict::kNotExcited:
      return "not excited";
    case GroupVerdict::kRejected:
      return "rejected";
    case GroupVerdict::kSkipped:
      return "skipped";
  }
  return "";
}

GroupVerdict verdict_of(const Judgement& judgement) {
  const auto may_be_used = [](const PurposeGrade& g) { return g.grade == Grade::kYes || g.grade == Grade::kWithCare; };
  if (may_be_used(judgement.parameters)) return GroupVerdict::kIdentified;
  return may_be_used(judgement.prediction) ? GroupVerdict::kEffective : GroupVerdict::kRejected;
}

namespace {

bool was_estimated(const Parameter& p) {
  return p.status != ParameterStatus::kFixed && p.status != ParameterStatus::kNotExcited;
}

bool is_weak(const Parameter& p) {
  return p.status == ParameterStatus::kIdentified && !(0.5 * (p.high95 - p.low95) <= kWeakShare * std::abs(p.value));
}

}  // namespace

std::vector<Parameter> marked(std::vector<Parameter> parameters, GroupVerdict verdict) {
  for (Parameter& p : parameters) {
    if (verdict == GroupVerdict::kIdentified && is_weak(p)) p.status = ParameterStatus::kWeak;
    if (!was_estimated(p)) continue;
    const bool worse = p.status == ParameterStatus::kImplausible || p.status == ParameterStatus::kAtBound;
    if (verdict == GroupVerdict::kRejected) p.status = ParameterStatus::kRejected;
    if (verdict == GroupVerdict::kEffective && !worse) p.status = ParameterStatus::kEffective;
  }
  return parameters;
}

std::vector<Parameter> marked(std::vector<Parameter> parameters, std::span<const Evidence> rows,
                              ParameterStatus status) {
  for (Parameter& p : parameters) {
    const bool objected =
        std::ranges::any_of(rows, [&](const Evidence& row) { return row.about == p.name && !row.passed(); });
    if (objected && was_estimated(p)) p.status = status;
  }
  return parameters;
}

const Parameter* MethodResult::find(std::string_view name) const { return find_parameter(parameters, name); }

Estimate estimate_of(const ParameterGroup& group, Eigen::MatrixXd covariance,
                     std::span<const PredictedQuantity> predictions) {
  Estimate estimate;
  estimate.subject = group.name;
  estimate.method = group.method;
  estimate.parameters = group.parameters;
  estimate.covariance = std::move(covariance);
  for (const MethodResult& other : group.methods) {
    if (other.method == group.method || !other.usable) continue;
    for (const Parameter& p : other.parameters) estimate.other_methods.push_back({other.method, p});
  }
  for (const PredictedQuantity& q : predictions)
    estimate.validation[q.name] = {q.fit.mae, q.fit.rmse, q.fit.r2, q.fit.theil, q.unit};
  estimate.verdict = group.reason;
  estimate.judgement = group.judgement;
  estimate.evidence = group.evidence;
  return estimate;
}

double Analysis::true_value(std::string_view parameter) const {
  const auto found = truth.find(parameter);
  return found == truth.end() ? kNaN : found->second;
}

}  // namespace veridyn::estimation
