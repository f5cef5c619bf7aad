// veridyn identify STUDY: from recording to parameters, validation and report.
#include <fmt/format.h>

#include <memory>

#include "apps/veridyn/aircraft_results.hpp"
#include "apps/veridyn/checkpoint.hpp"
#include "apps/veridyn/console.hpp"
#include "apps/veridyn/domains.hpp"
#include "apps/veridyn/drive_results.hpp"
#include "apps/veridyn/muscle_results.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::app {

namespace {

void refuse_checkpoint(const StudyRun& run) {
  // `demo`, which identifies too, has no such option.
  if (run.arguments.values.contains("--checkpoint") && !run.arguments.text("--checkpoint").empty())
    throw InputError("--checkpoint", "is for a person's tasks; identify of other studies starts from the beginning");
}

}  // namespace

int identify_aircraft(const StudyRun& run) {
  refuse_checkpoint(run);
  OutputFolder folder(run.options().out);
  TerminalProgress progress = progress_of(run.options());
  const aircraft::FlightStudy flight = aircraft::read_study(run.study, progress);
  const aircraft::FlightAnalysis analysis = aircraft::identify(flight, progress);
  if (analysis.interrupted) throw Interrupted();
  progress.stage("writing the results");
  publish_identification(run, folder, flight, analysis);
  return kDone;
}

int identify_vehicle(const StudyRun& run) {
  refuse_checkpoint(run);
  OutputFolder folder(run.options().out);
  TerminalProgress progress = progress_of(run.options());
  PreparedDrive drive = prepare_drive(run.study, progress);
  const vehicle::VehicleAnalysis analysis = vehicle::identify(drive.study, progress);
  if (analysis.interrupted) throw Interrupted();
  publish_drive(run, folder, drive, analysis);
  return kDone;
}

int identify_muscles(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  TerminalProgress progress = progress_of(run.options());
  const muscle::TaskStudy study = muscle::read_task_study(run.study, progress);
  const std::unique_ptr<numerics::ValueLog> log = open_value_log(run, study.inputs);
  const muscle::MuscleAnalysis analysis = muscle::identify(study, progress, log.get());
  if (analysis.interrupted) {
    if (log) print_line(run.options(), fmt::format("finished simulations are kept in {}", log->path().string()));
    throw Interrupted();
  }
  if (log && log->loaded() > 0)
    print_line(run.options(), fmt::format("{} simulations of the search were in {}", analysis.resumed,
                                          log->path().parent_path().string()));
  progress.stage("writing the results");
  publish_muscles(run, folder, study, analysis);
  return kDone;
}

Command identify_command() {
  return {
      .name = "identify",
      .summary = "from recording to parameters, validation and report",
      .arguments = {{.name = "STUDY",
                     .help =
                         "study file (TOML) of an aircraft's flight, a vehicle's drive, a person's tasks ([tasks] in "
                         "a study of muscles), a swing test or a calibration; `veridyn init` writes one to "
                         "start from",
                     .required = true},
                    checkpoint_argument()},
      .default_out = "out/identify",
      .example = "veridyn identify study.toml --out out/flight7 --set data.from=120",
      .run = [](const Arguments& arguments) { return run_on_study("identify", arguments); }};
}

}  // namespace veridyn::app
