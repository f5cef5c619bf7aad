// veridyn export STUDY: the subject's model for other programs: JSON, TOML, CSV, JSBSim.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/veridyn/output.hpp"
#include "veridyn/aircraft/model/estimated_subject.hpp"
#include "veridyn/aircraft/model/jsbsim.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/results/estimate_json.hpp"

namespace veridyn::app {
namespace {

struct Options {
  std::string study;
  std::string estimate;
  std::string format = "all";
  CommonOptions common;
};

std::string model_csv(const aircraft::Subject& subject) {
  std::string text = "coefficient,term,name,unit,value\n";
  for (const auto& model : subject.model.coefficients) {
    if (!model) continue;
    for (std::size_t i = 0; i < model->size(); ++i) {
      const std::string value = std::isfinite(model->values[i]) ? fmt::format("{}", model->values[i]) : "";
      text += fmt::format("{},\"{}\",{},{},{}\n", aircraft::name_of(model->coefficient), model->terms[i].expression,
                          aircraft::parameter_name(model->coefficient, model->terms[i]),
                          model->terms[i].parameter_unit(), value);
    }
  }
  return text;
}

int export_model(const Options& options) {
  const Study study = load_study(options.study, options.common);
  // Of a whole study only the subject matters here; the other tables are for other verbs to check.
  const StudyTable table = study.root().table("subject");
  aircraft::Subject subject = aircraft::read_subject(table);
  table.finish();
  std::optional<estimation::Estimate> estimate;
  if (!options.estimate.empty()) {
    estimate = io::read_estimate(options.estimate);
    subject = aircraft::estimated_subject(subject, *estimate, options.estimate);
  }
  const auto wanted = [&](const char* format) { return options.format == "all" || options.format == format; };
  // Everything is composed before the first file is written.
  std::vector<std::pair<const char*, std::string>> files;
  if (wanted("json")) files.emplace_back("model.json", aircraft::to_json(subject, estimate ? &*estimate : nullptr));
  if (wanted("toml")) files.emplace_back("subject.toml", aircraft::write_subject_toml(subject));
  if (wanted("csv")) files.emplace_back("model.csv", model_csv(subject));
  if (wanted("jsbsim")) files.emplace_back("jsbsim.xml", aircraft::write_jsbsim(subject));
  const std::filesystem::path folder = options.common.out;
  make_folder(folder);
  nlohmann::ordered_json summary = {{"folder", folder.string()}, {"files", nlohmann::ordered_json::array()}};
  for (const auto& [name, text] : files) {
    write_file(folder / name, text);
    summary["files"].push_back(name);
    tell(options.common, fmt::format("wrote {}", (folder / name).string()));
  }
  RunRecord run{"export", study.name(), study.to_toml(), 0, {options.study}};
  if (estimate) run.inputs.emplace_back(options.estimate);
  write_run_record(folder, run, options.common);
  print_summary(summary, options.common);
  return kDone;
}

}  // namespace

void add_export(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = program.add_subcommand("export", "the model for other programs: JSON, TOML, CSV, JSBSim XML");
  verb->add_option("STUDY", options->study, "study, or the subject.toml of an identification")->required();
  verb->add_option("--estimate", options->estimate, "take the parameters from this estimate.json")->type_name("FILE");
  verb->add_option("--format", options->format, "what to write")
      ->check(CLI::IsMember({"all", "json", "toml", "csv", "jsbsim"}))
      ->capture_default_str();
  add_common(*verb, options->common, "out/export",
             "veridyn export study.toml --estimate out/identify/estimate.json --format jsbsim");
  verb->callback([options, &exit_code] { exit_code = export_model(*options); });
}

}  // namespace veridyn::app
