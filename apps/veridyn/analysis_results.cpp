#include "apps/veridyn/analysis_results.hpp"

#include <fmt/format.h>

namespace veridyn::app {

using estimation::Parameter;

std::string parameters_csv(const estimation::Estimate& estimate) {
  std::string text = "name,value,sigma,low95,high95,unit,status\n";
  for (const Parameter& p : estimate.parameters) {
    text += fmt::format("{},{},{},{},{},{},{}\n", p.name, p.value, p.sigma, p.low95, p.high95, p.unit,
                        estimation::to_string(p.status));
  }
  return text;
}

std::string methods_csv(const estimation::Analysis& analysis) {
  std::string text = "parameter,method,value,sigma,low95,high95,unit\n";
  for (const estimation::ParameterGroup& group : analysis.groups) {
    for (const estimation::MethodResult& method : group.methods) {
      if (!method.usable) continue;
      for (const Parameter& p : method.parameters) {
        const Parameter* result = estimation::find_parameter(group.parameters, p.name);
        text += fmt::format("{},{},{},{},{},{},{}\n", p.name, method.method, p.value, p.sigma, p.low95, p.high95,
                            result == nullptr ? p.unit : result->unit);
      }
    }
  }
  return text;
}

}  // namespace veridyn::app
