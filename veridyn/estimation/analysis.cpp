#include "veridyn/estimation/analysis.hpp"

#include "veridyn/core/constants.hpp"

namespace veridyn::estimation {

std::string_view to_string(GroupVerdict verdict) {
  switch (verdict) {
    case GroupVerdict::kIdentified:
      return "identified";
    case GroupVerdict::kNotExcited:
      return "not excited";
    case GroupVerdict::kRejected:
      return "rejected";
    case GroupVerdict::kSkipped:
      return "skipped";
  }
  return "";
}

const Parameter* MethodResult::find(std::string_view name) const { return find_parameter(parameters, name); }

double Analysis::true_value(std::string_view parameter) const {
  const auto found = truth.find(parameter);
  return found == truth.end() ? kNaN : found->second;
}

}  // namespace veridyn::estimation
