// veridyn export STUDY: the subject's model for other programs; of an aircraft JSON, TOML, CSV, JSBSim.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "apps/veridyn/results/analysis_results.hpp"
#include "apps/veridyn/results/export_results.hpp"
#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/aircraft/model/estimated_subject.hpp"
#include "veridyn/aircraft/model/jsbsim.hpp"
#include "veridyn/aircraft/simulation/simulate_study.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/subject_grades.hpp"

namespace veridyn::app {
namespace {

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

}  // namespace

int export_aircraft(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  const StudyTable& root = run.study.root();
  aircraft::Subject subject = aircraft::read_subject(root.table("subject"));
  if (root.has("flight")) static_cast<void>(aircraft::read_simulation(root));
  finish_flight_study(root);
  const std::optional<estimation::Estimate> estimate = given_estimate(run);
  if (estimate) subject = aircraft::estimated_subject(subject, *estimate, run.arguments.text("--estimate-file"));
  const std::string& format = run.arguments.text("--format");
  if (format == "tir")
    throw InputError(run.path.string(), "--format tir is for vehicles; an aircraft has json, toml, csv and jsbsim");
  const auto desired = [&](const char* name) { return format == "all" || format == name; };
  if (desired("json")) folder.write("model.json", aircraft::to_json(subject, estimate ? &*estimate : nullptr));
  // What was graded says for which purposes its numbers may be used.
  const bool graded = is_graded(estimate);
  const std::string toml = aircraft::write_subject_toml(subject);
  if (desired("toml")) folder.write("subject.toml", graded ? estimation::graded_toml(toml, estimate->judgement) : toml);
  if (desired("csv")) folder.write("model.csv", model_csv(subject));
  std::string note;
  if (desired("jsbsim")) {
    try {
      const std::string xml = aircraft::write_jsbsim(subject);
      folder.write("jsbsim.xml", graded ? graded_xml(xml, estimate->judgement) : xml);
    } catch (const InputError& refusal) {
      // What is known of an aircraft goes into the files that can hold a part of it.
      if (format != "all") throw;
      note = fmt::format("no jsbsim.xml: {}", refusal.what());
    }
  }
  publish_export(run, folder, {}, estimate, note);
  return kDone;
}

Command export_command() {
  return {.name = "export",
          .summary = "the model for other programs: TOML, CSV; of an aircraft JSON, JSBSim XML; of a vehicle .tir",
          .arguments = {{.name = "STUDY", .help = "study, or the subject.toml of an identification", .required = true},
                        {.name = "--estimate-file",
                         .help = "take the parameters from this estimate.json",
                         .type = "FILE",
                         .old_name = "--estimate"},
                        {.name = "--format",
                         .help = "what to write",
                         .value = "all",
                         .choices = {"all", "json", "toml", "csv", "jsbsim", "tir"}}},
          .default_out = "out/export",
          .example = "veridyn export study.toml --estimate-file out/identify/estimate.json --format jsbsim",
          .run = [](const Arguments& arguments) { return run_on_study("export", arguments); }};
}

}  // namespace veridyn::app
