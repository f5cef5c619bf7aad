#include "apps/veridyn/results/analysis_results.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/veridyn/run/console.hpp"
#include "veridyn/estimation/judgement/reasons.hpp"
#include "veridyn/io/results/estimate_json.hpp"

namespace veridyn::app {
namespace {

using estimation::Analysis;
using estimation::Estimate;
using estimation::Parameter;
using estimation::ParameterGroup;

std::string parameters_csv(const Estimate& estimate) {
  std::string text = "name,value,sigma,low95,high95,unit,status\n";
  for (const Parameter& p : estimate.parameters) {
    text += fmt::format("{},{},{},{},{},{},{}\n", p.name, p.value, p.sigma, p.low95, p.high95, p.unit,
                        estimation::to_string(p.status));
  }
  return text;
}

std::string derived_csv(const Estimate& estimate) {
  std::string text = "name,value,low95,high95,unit,note\n";
  for (const estimation::DerivedQuantity& quantity : estimate.derived)
    text += fmt::format("{},{},{},{},{},\"{}\"\n", quantity.name, quantity.value, quantity.low95, quantity.high95,
                        quantity.unit, quantity.note);
  return text;
}

std::string methods_csv(const Analysis& analysis) {
  std::string text = "parameter,method,value,sigma,low95,high95,unit\n";
  for (const ParameterGroup& group : analysis.groups) {
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

Summary summary_of(const std::filesystem::path& folder, const Analysis& analysis, const MoreResults& more) {
  const estimation::GroupVerdict verdict = analysis.groups.size() == 1
                                               ? analysis.groups.front().verdict
                                               : estimation::verdict_of(analysis.estimate.judgement);
  Summary summary = Summary::object({{"folder", folder.string()},
                                     {"verdict", estimation::to_string(verdict)},
                                     {"sentence", estimation::sentence_of(analysis.estimate)},
                                     {"groups", Summary::array()}});
  for (const ParameterGroup& group : analysis.groups) {
    summary["groups"].push_back(Summary::object({{"name", group.name},
                                                 {"verdict", estimation::to_string(group.verdict)},
                                                 {"reason", group.reason},
                                                 {"method", group.method}}));
  }
  summary["estimate"] = Summary::json(io::to_json(analysis.estimate));
  for (const auto& [name, value] : more.summary) summary[name] = value;
  return summary;
}

/// The three grades, what decided and what to do.
std::vector<std::string> judgement_lines(const Estimate& estimate) {
  std::vector<std::string> lines{estimation::sentence_of(estimate)};
  const estimation::Reasons reasons = estimation::reasons_of(estimate.evidence);
  for (const estimation::Reason& reason : reasons.lines)
    lines.push_back(
        fmt::format("  {:<12} {}", reason.is_advice ? "to do" : estimation::to_string(reason.outcome), reason.text));
  if (reasons.left_out > 0) lines.push_back(fmt::format("  {:<12} and {} more, in the report", "", reasons.left_out));
  return lines;
}

/// What became of the groups; why one is rejected is among the lines above, or in the report.
std::vector<std::string> group_lines(const Analysis& analysis) {
  std::vector<std::string> lines;
  for (const ParameterGroup& group : analysis.groups) {
    const bool rejected = group.verdict == estimation::GroupVerdict::kRejected && !analysis.interrupted;
    lines.push_back(
        fmt::format("  {:<12} {}", estimation::to_string(group.verdict), rejected ? group.name : group.reason));
  }
  if (lines.empty() && !analysis.estimate.verdict.empty()) lines.push_back("  " + analysis.estimate.verdict);
  return lines;
}

std::vector<std::string> parameter_lines(const Estimate& estimate) {
  std::size_t widest = 0;
  for (const Parameter& p : estimate.parameters) widest = std::max(widest, p.name.size());
  std::vector<std::string> lines;
  for (const Parameter& p : estimate.parameters)
    lines.push_back(fmt::format("  {:<{}} {:>12.5g} +- {:<9.2g} {:<12} {}", p.name, widest, p.value, p.sigma,
                                p.unit == "1" ? "" : p.unit, estimation::to_string(p.status)));
  return lines;
}

/// A line a group: "short period  frequency 4.91 (4.71 to 5.12) rad/s, damping 0.61 (0.55 to 0.68)".
std::vector<std::string> derived_lines(const Estimate& estimate) {
  std::vector<std::string> lines;
  std::string_view group;
  for (const estimation::DerivedQuantity& quantity : estimate.derived) {
    std::string name = quantity.name.substr(quantity.name.find('.') + 1);
    std::ranges::replace(name, '_', ' ');
    std::string text = fmt::format("{} {:.3g}", name, quantity.value);
    if (quantity.low95 < quantity.high95) text += fmt::format(" ({:.3g} to {:.3g})", quantity.low95, quantity.high95);
    if (quantity.unit != "1") text += " " + quantity.unit;
    if (quantity.group == group)
      lines.back() += ", " + text;
    else
      lines.push_back(fmt::format("  {:<12} {}", quantity.group, text));
    group = quantity.group;
  }
  return lines;
}

std::vector<std::string> prediction_lines(const Analysis& analysis) {
  std::vector<std::string> lines;
  for (const estimation::PredictedQuantity& q : analysis.predictions) {
    // What a group of parameters explains is said with it.
    if (std::ranges::find(analysis.groups, q.name, &ParameterGroup::name) == analysis.groups.end())
      lines.push_back(fmt::format("  hold-out     {}: R2 {:.3f}, RMSE {:.3g} {}", q.name, q.fit.r2, q.fit.rmse,
                                  q.unit == "1" ? "" : q.unit));
  }
  for (const estimation::RecordingUse& recording : analysis.estimate.recordings) {
    std::string scores;
    for (const auto& [name, v] : recording.validation) scores += fmt::format(", R2 of {} {:.2f}", name, v.r2);
    lines.push_back(fmt::format("  recording    {}: {}{}", recording.name, recording.use, scores));
  }
  for (const estimation::NextMeasurement& next : analysis.estimate.next_measurements)
    lines.push_back(fmt::format("  next         {}: widest interval +-{:.2g} % ({}) -> {:.2g} % ({})", next.name,
                                100.0 * next.share_now, next.widest_now, 100.0 * next.share_then, next.widest_then));
  return lines;
}

void print_analysis(const CommonOptions& options, const std::filesystem::path& folder, const Analysis& analysis,
                    const MoreResults& more) {
  const Estimate& estimate = analysis.estimate;
  const auto print = [&](const std::vector<std::string>& lines) {
    for (const std::string& line : lines) print_line(options, line);
  };
  // What has no rows is not judged: a calibration, a swing test.
  if (!estimate.evidence.empty()) print(judgement_lines(estimate));
  print(group_lines(analysis));
  if (!estimate.structure_reason.empty())
    print_line(options, "  " + estimate.structure_reason);
  else if (!estimate.structure.empty())
    print_line(options, fmt::format("  structure: {}, as the study says", estimate.structure));
  print(parameter_lines(estimate));
  print(derived_lines(estimate));
  print(prediction_lines(analysis));
  print(more.lines);
  for (const std::string& warning : estimate.warnings) print_line(options, "warning: " + warning);
  print_line(options, fmt::format("report: {}", (folder / "report.html").string()));
}

}  // namespace

void publish_analysis(OutputFolder& folder, const RunRecord& record, const CommonOptions& options,
                      const Analysis& analysis, const MoreResults& more) {
  folder.write("estimate.json", io::to_json(analysis.estimate));
  folder.write("parameters.csv", parameters_csv(analysis.estimate));
  if (!analysis.estimate.derived.empty()) folder.write("derived.csv", derived_csv(analysis.estimate));
  if (std::ranges::any_of(analysis.groups, [](const ParameterGroup& group) { return group.methods.size() > 1; }))
    folder.write("methods.csv", methods_csv(analysis));
  folder.publish(record, options, summary_of(folder.path(), analysis, more));
  print_analysis(options, folder.path(), analysis, more);
}

std::string graded_xml(const std::string& xml, const estimation::Judgement& judgement) {
  const std::size_t after_declaration = xml.find('\n') + 1;
  return fmt::format("{}<!-- {} -->\n{}", xml.substr(0, after_declaration), estimation::sentence_of(judgement),
                     xml.substr(after_declaration));
}

}  // namespace veridyn::app
