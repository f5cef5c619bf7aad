// veridyn identify STUDY: from recording to parameters, validation and report.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "apps/veridyn/results/aircraft_results.hpp"
#include "apps/veridyn/results/checkpoint.hpp"
#include "apps/veridyn/results/drive_results.hpp"
#include "apps/veridyn/results/muscle_results.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/work_progress.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::app {

namespace {

void refuse_checkpoint(const StudyRun& run) {
  const std::string option = search_checkpoint_argument().name;
  if (run.arguments.given(option))
    throw InputError(option, "is for a person's tasks; other studies are identified at once, in one process");
}

}  // namespace

int identify_aircraft(const StudyRun& run) {
  refuse_checkpoint(run);
  OutputFolder folder(run.options().out);
  WorkProgress progress(run, &folder);
  const std::vector<aircraft::FlightStudy> flights = aircraft::read_flights(run.study, progress);
  if (run.options().threads != 1) folder.hash_ahead(inputs_of(flights));
  const aircraft::FlightAnalysis analysis = aircraft::identify(flights, progress);
  if (analysis.interrupted) throw Interrupted();
  progress.stage("writing the results");
  publish_identification(run, folder, flights, analysis);
  return kDone;
}

int identify_vehicle(const StudyRun& run) {
  refuse_checkpoint(run);
  OutputFolder folder(run.options().out);
  WorkProgress progress(run, &folder);
  PreparedDrive drive = prepare_drive(run.study, progress);
  if (run.options().threads != 1) folder.hash_ahead(drive.study.inputs);
  const vehicle::VehicleAnalysis analysis = vehicle::identify(drive.study, progress);
  // The best that was found by then is worth its files.
  if (analysis.interrupted && analysis.identification.best() == nullptr) throw Interrupted();
  publish_drive(run, folder, drive, analysis);
  return analysis.interrupted ? kFailed : kDone;
}

int identify_muscles(const StudyRun& asked) {
  const Checkpoint checkpoint = checkpoint_of(asked.arguments);
  StudyRun run = asked;
  run.arguments.common = checkpoint.options;
  const CommonOptions& options = run.options();
  std::optional<OutputFolder> folder;
  if (checkpoint.first()) folder.emplace(options.out);
  WorkProgress progress(run, folder ? &*folder : nullptr);
  const muscle::TaskStudy study = muscle::read_task_study(run.study, progress);
  const std::unique_ptr<numerics::ValueLog> log = open_value_log(checkpoint, run, study.inputs);
  const muscle::MuscleAnalysis analysis = muscle::identify(study, progress, log.get(), options.ranks);
  if (analysis.interrupted) {
    if (log) print_line(options, fmt::format("finished simulations are kept in {}", log->folder().string()));
    throw Interrupted();
  }
  if (!checkpoint.first()) return kDone;
  if (log && log->loaded() > 0)
    print_line(options,
               fmt::format("{} simulations of the search were in {}", analysis.resumed, log->folder().string()));
  progress.stage("writing the results");
  publish_muscles(run, *folder, study, analysis);
  return kDone;
}

Command identify_command() {
  Command command = {
      .name = "identify",
      .summary = "from recording to parameters, validation and report",
      .arguments = {{.name = "STUDY",
                     .help =
                         "study file (TOML) of an aircraft's flight, a vehicle's drive, a person's tasks ([tasks] in "
                         "a study of muscles), a swing test or a calibration; `veridyn init` writes one to "
                         "start from",
                     .required = true}},
      .default_out = "out/identify",
      .example = "veridyn identify study.toml --out out/flight7 --set data.from=120",
      .run = [](const Arguments& arguments) { return run_on_study("identify", arguments); },
      .shares_work = true};
  command.arguments.push_back(search_checkpoint_argument());
  return command;
}

}  // namespace veridyn::app
