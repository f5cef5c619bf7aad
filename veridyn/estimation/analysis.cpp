#include "veridyn/estimation/analysis.hpp"

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

std::vector<Parameter> marked(std::vector<Parameter> parameters, GroupVerdict verdict) {
  if (verdict != GroupVerdict::kEffective && verdict != GroupVerdict::kRejected) return parameters;
  for (Parameter& p : parameters) {
    if (p.status == ParameterStatus::kFixed || p.status == ParameterStatus::kNotExcited) continue;
    p.status = verdict == GroupVerdict::kEffective ? ParameterStatus::kEffective : ParameterStatus::kRejected;
  }
  return parameters;
}

const Parameter* MethodResult::find(std::string_view name) const { return find_parameter(parameters, name); }

double Analysis::true_value(std::string_view parameter) const {
  const auto found = truth.find(parameter);
  return found == truth.end() ? kNaN : found->second;
}

}  // namespace veridyn::estimation
