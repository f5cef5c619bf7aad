// veridyn export STUDY: the subject's model for other programs; of an aircraft JSON, TOML, CSV, JSBSim.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "apps/veridyn/results/analysis_results.hpp"
#include "apps/veridyn/results/export_results.hpp"
#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/aircraft/export/jsbsim_export.hpp"
#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/aircraft/model/estimated_subject.hpp"
#include "veridyn/aircraft/simulation/simulate_study.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/subject_grades.hpp"
#include "veridyn/io/results/estimate_json.hpp"

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

using estimation::Estimate;

/// What an aircraft is exported from.
struct KnownAircraft {
  aircraft::Subject study;         ///< as its file states it
  aircraft::Subject known;         ///< with the estimate's values
  std::optional<Estimate> given;   ///< of `--estimate-file`
  std::optional<Estimate> beside;  ///< that the identification wrote with the subject
  std::vector<std::filesystem::path> inputs = {};

  [[nodiscard]] const Estimate* estimate() const { return given ? &*given : beside ? &*beside : nullptr; }
};

/// An estimate without the moments per unit of inertia, which are no parameters of the model.
Estimate of_the_model(Estimate estimate, const aircraft::Subject& subject) {
  for (const auto& model : subject.model.coefficients) {
    if (!model || !aircraft::per_unit_inertia(model->coefficient, subject)) continue;
    for (const aircraft::Term& term : model->terms) {
      const std::string name = aircraft::regressed_parameter_name(model->coefficient, term, subject);
      std::erase_if(estimate.parameters, [&](const estimation::Parameter& p) { return p.name == name; });
    }
  }
  return estimate;
}

/// The estimate.json beside a subject.toml, where the subject's values are from it.
std::optional<Estimate> estimate_beside(const StudyRun& run, const aircraft::Subject& subject,
                                        std::vector<std::filesystem::path>& inputs) {
  if (run.path.filename() != "subject.toml") return std::nullopt;
  const std::filesystem::path file = run.path.parent_path() / "estimate.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  Estimate estimate = io::read_estimate(file);
  if (estimate.subject != subject.name) return std::nullopt;
  for (const auto& model : subject.model.coefficients) {
    if (!model) continue;
    for (std::size_t i = 0; i < model->size(); ++i) {
      const double value = model->values[i];
      const auto* p = estimate.find(aircraft::parameter_name(model->coefficient, model->terms[i]));
      if (std::isfinite(value) && (p == nullptr || p->value != value)) return std::nullopt;
    }
  }
  inputs.push_back(file);
  return estimate;
}

/// The condition that the exported aircraft is flown in.
aircraft::ExportCondition condition_of(const KnownAircraft& from,
                                       const std::optional<aircraft::SimulationOptions>& flight) {
  if (const Estimate* estimate = from.estimate())
    if (const auto condition = aircraft::condition_of(*estimate)) return *condition;
  if (flight)
    return {flight->airspeed, aircraft::standard_atmosphere(flight->altitude).density, "of the study's flight"};
  return {aircraft::default_airspeed(from.known), aircraft::kSeaLevelDensity, "where the lift coefficient is 0.5"};
}

/// For programs: where numbers are from, and how the file flew.
Summary jsbsim_summary(const aircraft::CompletedSubject& completed, const aircraft::TrialFlight& trial) {
  Summary sources = Summary::object();
  for (const aircraft::SourcedValue& value : completed.values)
    sources[value.name] = Summary::object({{"from", aircraft::kValueOriginNames[value.origin]}, {"text", value.text}});
  Summary modes = Summary::array();
  for (const aircraft::FlownMode& mode : trial.modes)
    modes.push_back(Summary::object({{"name", aircraft::words_of(mode.linear.mode)},
                                     {"growth", mode.linear.s.real()},
                                     {"flown", mode.growth},
                                     {"as_predicted", mode.verdict == aircraft::ModeVerdict::kAsPredicted}}));
  return Summary::object({{"sources", std::move(sources)},
                          {"airspeed", trial.condition.airspeed},
                          {"altitude", aircraft::standard_altitude(trial.condition.density)},
                          {"trimmed", trial.trim.usable()},
                          {"alpha", trial.trim.alpha},
                          {"elevator", trial.trim.controls.de},
                          {"throttle", trial.trim.controls.throttle},
                          {"flies_as_predicted", trial.as_predicted()},
                          {"modes", std::move(modes)}});
}

/// The JSBSim file with what has to be said of it.
std::string jsbsim_of(const KnownAircraft& from, const std::optional<aircraft::SimulationOptions>& flight,
                      MoreResults& more) {
  const aircraft::CompletedSubject completed =
      aircraft::complete_subject(from.known, from.study, from.estimate(), condition_of(from, flight));
  const aircraft::TrialFlight trial = aircraft::fly_trial(completed);
  more.lines.emplace_back("jsbsim.xml takes from");
  for (const std::string& line : aircraft::origin_lines(completed)) more.lines.push_back("  " + line);
  more.lines.emplace_back("and was flown before it was written");
  for (std::string& line : aircraft::trial_lines(trial)) more.lines.push_back("  " + line);
  if (!completed.all_known())
    more.lines.emplace_back("what is estimated or left zero says how such an aircraft flies, not how this one does");
  more.summary.emplace_back("jsbsim", jsbsim_summary(completed, trial));
  return aircraft::jsbsim_file(completed, &trial);
}

}  // namespace

int export_aircraft(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  const StudyTable& root = run.study.root();
  KnownAircraft from{.study = aircraft::read_subject(root.table("subject")), .known = {}, .given = given_estimate(run)};
  std::optional<aircraft::SimulationOptions> flight;
  if (root.has("flight")) flight = aircraft::read_simulation(root);
  finish_flight_study(root);
  from.known = from.study;
  if (from.given)
    from.known = aircraft::estimated_subject(from.study, of_the_model(*from.given, from.study),
                                             run.arguments.text("--estimate-file"));
  else
    from.beside = estimate_beside(run, from.study, from.inputs);
  const std::string& format = run.arguments.text("--format");
  if (format == "tir")
    throw InputError(run.path.string(), "--format tir is for vehicles; an aircraft has json, toml, csv and jsbsim");
  const auto desired = [&](const char* name) { return format == "all" || format == name; };
  const std::optional<Estimate>& estimate = from.given ? from.given : from.beside;
  if (desired("json")) folder.write("model.json", aircraft::to_json(from.known, from.estimate()));
  // What was graded says for which purposes its numbers may be used.
  const bool graded = is_graded(estimate);
  const std::string toml = aircraft::write_subject_toml(from.known);
  if (desired("toml"))
    folder.write("subject.toml", graded ? estimation::graded_toml(toml, estimate->judgement)
                                        : toml + estimation::grades_table(root.table("subject")));
  if (desired("csv")) folder.write("model.csv", model_csv(from.known));
  MoreResults more;
  if (desired("jsbsim")) {
    try {
      const std::string xml = jsbsim_of(from, flight, more);
      folder.write("jsbsim.xml", graded ? graded_xml(xml, estimate->judgement) : xml);
    } catch (const InputError& refusal) {
      // What is known of an aircraft goes into the files that can hold a part of it.
      if (format != "all") throw;
      more.lines = {fmt::format("no jsbsim.xml: {}", refusal.what())};
    }
  }
  publish_export(run, folder, from.inputs, estimate, more);
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
