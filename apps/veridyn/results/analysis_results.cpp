#include "apps/veridyn/results/analysis_results.hpp"

#include <fmt/format.h>

#include "apps/veridyn/run/console.hpp"
#include "veridyn/estimation/judgement/reasons.hpp"
#include "veridyn/io/results/estimate_json.hpp"

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

void print_judgement(const CommonOptions& options, const estimation::Estimate& estimate) {
  print_line(options, estimation::sentence_of(estimate));
  const estimation::Reasons reasons = estimation::reasons_of(estimate.evidence);
  for (const estimation::Reason& reason : reasons.lines)
    print_line(options, fmt::format("  {:<10} {}", reason.is_advice ? "to do" : estimation::to_string(reason.outcome),
                                    reason.text));
  if (reasons.left_out > 0)
    print_line(options, fmt::format("  {:<10} and {} more, in the report", "", reasons.left_out));
}

std::string graded_xml(const std::string& xml, const estimation::Judgement& judgement) {
  const std::size_t after_declaration = xml.find('\n') + 1;
  return fmt::format("{}<!-- {} -->\n{}", xml.substr(0, after_declaration), estimation::sentence_of(judgement),
                     xml.substr(after_declaration));
}

Summary estimate_summary(const std::filesystem::path& folder, const estimation::Estimate& estimate,
                         std::span<const estimation::ParameterGroup> groups) {
  const estimation::GroupVerdict verdict =
      groups.size() == 1 ? groups.front().verdict : estimation::verdict_of(estimate.judgement);
  Summary summary = Summary::object({{"folder", folder.string()},
                                     {"verdict", estimation::to_string(verdict)},
                                     {"sentence", estimation::sentence_of(estimate)},
                                     {"groups", Summary::array()}});
  for (const estimation::ParameterGroup& group : groups) {
    summary["groups"].push_back(Summary::object({{"name", group.name},
                                                 {"verdict", estimation::to_string(group.verdict)},
                                                 {"reason", group.reason},
                                                 {"method", group.method}}));
  }
  summary["estimate"] = Summary::json(io::to_json(estimate));
  return summary;
}

}  // namespace veridyn::app
