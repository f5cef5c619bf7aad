// veridyn sensitivity STUDY of muscles: which muscle moves which task, which tasks excite every muscle, first and total
// indices. Vehicles and aircraft: sensitivity_vehicle.cpp, sensitivity_aircraft.cpp.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <stdexcept>

#include "apps/veridyn/results/checkpoint.hpp"
#include "apps/veridyn/results/response_results.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/io/results/indices_csv.hpp"
#include "veridyn/muscle/sensitivity/sensitivity_tables.hpp"
#include "veridyn/muscle/study/muscle_study_sensitivity.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/sensitivity_report.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::muscle;

Summary summary_of(const TaskSet& set, const MuscleSensitivity& s) {
  Summary names = Summary::array();
  for (const std::size_t t : set.tasks) names.push_back(s.tasks[t].name);
  return Summary::object({{"tasks", std::move(names)},
                          {"muscles_excited", set.excited},
                          {"weakest_muscle", s.muscles[set.weakest_muscle]},
                          {"weakest_share", set.weakest},
                          {"mean_share", set.mean}});
}

Summary summary_of(const std::filesystem::path& folder, const SensitivityStudy& study, const MuscleSensitivity& r) {
  Summary s;
  s["folder"] = folder.string();
  s["model"] = study.subject.model_name;
  s["samples"] = r.sampling.samples;
  s["simulations"] = r.sampling.simulations;
  s["index_simulations"] = r.indices.simulations;
  if (r.cover.chosen) s["chosen"] = summary_of(*r.cover.chosen, r);
  if (r.cover.runner_up) s["runner_up"] = summary_of(*r.cover.runner_up, r);
  s["tasks"] = Summary::array();
  for (std::size_t t = 0; t < r.tasks.size(); ++t) {
    Summary task;
    task["name"] = r.tasks[t].name;
    task["obstacle"] = r.tasks[t].obstacle;
    task["wrap_bands"] = r.tasks[t].wrap_bands;
    task["failed"] = r.tasks[t].failed;
    task["mean_nrmse"] = Summary::object();
    for (std::size_t m = 0; m < r.muscles.size(); ++m) task["mean_nrmse"][r.muscles[m]] = r.sampling.mean(m, t);
    s["tasks"].push_back(std::move(task));
  }
  s["indices"] = Summary::array();
  for (const ResultIndices& i : r.indices.results) s["indices"].push_back(indices_summary(i, r.indices.inputs));
  s["warnings"] = r.warnings;
  s["notes"] = study.notes;
  return s;
}

void print_result(const CommonOptions& options, const MuscleSensitivity& r) {
  const auto set = [&](const char* name, const TaskSet& s) {
    print_line(
        options,
        fmt::format("{}: tasks {}: {} of {} muscles, the weakest ({}) has {:.0f} % of its greatest NRMSE", name,
                    task_list(r, s), s.excited, r.muscles.size(), r.muscles[s.weakest_muscle], 100.0 * s.weakest));
  };
  set("chosen", *r.cover.chosen);
  if (r.cover.runner_up) set("runner-up", *r.cover.runner_up);
}

}  // namespace

int sensitivity_muscle(const StudyRun& run) {
  const Checkpoint checkpoint = checkpoint_of(run.arguments);
  const CommonOptions& options = checkpoint.options;
  std::optional<OutputFolder> folder;
  if (checkpoint.first()) folder.emplace(options.out);
  TerminalProgress progress = progress_of(options);
  const SensitivityStudy study = read_sensitivity_study(run.study, progress);
  numerics::BlockStore store = open_store(checkpoint, run, study.inputs);
  progress.stage(fmt::format("computed muscle control of {} tasks", study.tasks.size()));
  const std::vector<PreparedTask> tasks = prepare_tasks(*study.subject.system, study.tasks, progress);
  if (progress.interrupted()) throw Interrupted();
  const MuscleSensitivity result = analyse_sensitivity(*study.subject.system, tasks, study.options, store, progress);
  if (!result.completed) return checkpoint.stopped(store);
  if (!checkpoint.first()) return kDone;
  progress.stage("writing the results");
  folder->write("sensitivity.csv", sensitivity_csv(result));
  folder->write("tasks.csv", task_choice_csv(result, tasks));
  if (!result.indices.results.empty())
    folder->write("indices.csv",
                  io::indices_csv(result.indices.results, result.indices.inputs, study.options.indices.method));
  folder->write("report.html", report::to_html(report::sensitivity_report(study, tasks, result, program_name())));
  const std::string files = fmt::format("{}", fmt::join(folder->files(), ", "));
  folder->publish(run.record(study.seed, study.inputs), options, summary_of(folder->path(), study, result));
  for (const std::string& warning : store.warnings()) print_line(options, "warning: " + warning);
  for (const std::string& warning : result.warnings) print_line(options, "warning: " + warning);
  if (!result.usable())
    throw std::runtime_error(
        fmt::format("none of {} tasks may be chosen; why is in {}: {}", tasks.size(), folder->path().string(), files));
  print_result(options, result);
  if (!checkpoint.folder.empty())
    print_line(options,
               fmt::format("{} of {} blocks were in {}", store.found(), store.blocks(), checkpoint.folder.string()));
  print_line(options, fmt::format("wrote {} in {}", files, folder->path().string()));
  return kDone;
}

Command sensitivity_command() {
  Command command = {
      .name = "sensitivity",
      .summary = "which parameter moves which result of a simulated motion",
      .arguments = {{.name = "STUDY",
                     .help = "study file (TOML). Muscles: [tasks] says which tasks, [sensitivity] how they "
                             "are sampled and chosen. Vehicle: the simulated [drive]; aircraft: the "
                             "simulated [flight]; [sensitivity] says what varies and how far",
                     .required = true}},
      .default_out = "out/sensitivity",
      .example =
          "veridyn sensitivity arm.toml --set tasks.numbers=all --out out/arm\n"
          "  veridyn sensitivity step_steer.toml --set sensitivity.method=morris",
      .run = [](const Arguments& arguments) { return run_on_study("sensitivity", arguments); },
      .shares_work = true};
  for (Argument& argument : checkpoint_arguments()) command.arguments.push_back(std::move(argument));
  return command;
}

}  // namespace veridyn::app
