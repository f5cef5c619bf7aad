#include "apps/veridyn/results/analysis_results.hpp"

#include <fmt/format.h>

#include "apps/veridyn/run/console.hpp"
#include "veridyn/estimation/judgement/reasons.hpp"

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

Summary grades_summary(const estimation::Judgement& judgement) {
  Summary grades = Summary::object();
  for (const estimation::Purpose purpose : estimation::kPurposes) {
    const estimation::PurposeGrade& g = judgement.of(purpose);
    grades[estimation::to_string(purpose)] =
        Summary::object({{"grade", estimation::to_string(g.grade)}, {"because", g.decided_by}});
  }
  return grades;
}

}  // namespace veridyn::app
