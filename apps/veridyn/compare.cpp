// veridyn compare A B ...: estimates of flights, methods or programs side by side.
#include <fmt/format.h>

#include <algorithm>

#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/result/estimate_comparison.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/report/comparison_report.hpp"
#include "veridyn/report/document/html.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::estimation;

/// A run's folder stands for its estimate.json.
std::filesystem::path file_of(const std::filesystem::path& given) {
  return std::filesystem::is_directory(given) ? given / "estimate.json" : given;
}

/// "flight1" of flight1/estimate.json, else the file's name; numbered where names repeat.
std::string name_of(const std::filesystem::path& file, const std::vector<NamedEstimate>& others) {
  const bool plain = file.filename() == "estimate.json" && file.has_parent_path();
  std::string name = plain ? file.parent_path().filename().string() : file.stem().string();
  const auto taken = [&](const std::string& n) {
    return std::ranges::find(others, n, &NamedEstimate::name) != others.end();
  };
  if (!taken(name)) return name;
  int number = 2;
  while (taken(fmt::format("{} {}", name, number))) ++number;
  return fmt::format("{} {}", name, number);
}

std::string comparison_csv(const EstimateComparison& comparison, const std::vector<NamedEstimate>& estimates) {
  std::string text = "parameter,unit";
  for (const NamedEstimate& e : estimates) text += fmt::format(",\"{0}\",\"sigma {0}\"", e.name);
  text += ",mean,sigma_mean,scatter,q,p\n";
  for (const ComparedParameter& p : comparison.parameters) {
    text += fmt::format("{},{}", p.name, p.unit);
    for (const Parameter* by : p.by)
      text += by != nullptr ? fmt::format(",{},{}", by->value, by->sigma) : std::string(",,");
    text += fmt::format(",{},{},{},{},{}\n", p.mean, p.sigma, p.between_sigma, p.q, p.p);
  }
  return text;
}

Summary summary_of(const EstimateComparison& comparison, const std::vector<NamedEstimate>& estimates) {
  Summary summary;
  summary["verdict"] = comparison.text;
  summary["pairs"] = Summary::array();
  for (const ComparedPair& pair : comparison.pairs)
    summary["pairs"].push_back(Summary::object({{"first", estimates[pair.first].name},
                                                {"second", estimates[pair.second].name},
                                                {"parameters", pair.parameters},
                                                {"chi_square", pair.chi_square},
                                                {"p", pair.p},
                                                {"largest", pair.largest},
                                                {"largest_sigmas", pair.largest_sigmas}}));
  summary["parameters"] = Summary::object();
  for (const ComparedParameter& p : comparison.parameters)
    summary["parameters"][p.name] =
        Summary::object({{"mean", p.mean}, {"sigma", p.sigma}, {"scatter", p.between_sigma}, {"q", p.q}, {"p", p.p}});
  summary["notes"] = comparison.notes;
  return summary;
}

int compare(const Arguments& arguments) {
  const CommonOptions& options = arguments.common;
  std::vector<NamedEstimate> estimates;
  std::vector<std::filesystem::path> inputs;
  for (const std::string& given : arguments.texts("ESTIMATES")) {
    const std::filesystem::path file = file_of(given);
    estimates.push_back({name_of(file, estimates), io::read_estimate(file)});
    inputs.push_back(file);
  }
  const EstimateComparison comparison = compare_estimates(estimates);
  OutputFolder folder(options.out);
  Summary summary = summary_of(comparison, estimates);
  summary["folder"] = folder.path().string();
  folder.write("comparison.csv", comparison_csv(comparison, estimates));
  folder.write("comparison.json", summary.to_json());
  folder.write("report.html", report::to_html(report::comparison_report(comparison, estimates, program_name())));
  folder.publish({.command = "compare", .study_name = "compare", .study_toml = {}, .inputs = inputs}, options, summary);
  for (const Evidence& row : comparison.evidence) print_line(options, "  " + estimation::says(row));
  print_line(options, comparison.text);
  print_line(options, fmt::format("report: {}", (folder.path() / "report.html").string()));
  return kDone;
}

}  // namespace

Command compare_command() {
  return {.name = "compare",
          .summary = "estimates of flights, methods or programs side by side: do they agree?",
          .arguments = {{.name = "ESTIMATES",
                         .help = "estimate.json of several runs, or the runs' folders, of any domain or program",
                         .value = std::vector<std::string>(),
                         .required = true}},
          .default_out = "out/compare",
          .example = "veridyn compare out/flight7 out/flight8 handbook.json",
          .run = compare};
}

}  // namespace veridyn::app
