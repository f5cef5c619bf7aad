// veridyn identify STUDY: from recording to parameters, validation and report.
#include "apps/veridyn/aircraft_results.hpp"
#include "apps/veridyn/console.hpp"
#include "apps/veridyn/domains.hpp"
#include "apps/veridyn/drive_results.hpp"

namespace veridyn::app {

int identify_aircraft(const StudyRun& run) {
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
  OutputFolder folder(run.options().out);
  TerminalProgress progress = progress_of(run.options());
  PreparedDrive drive = prepare_drive(run.study, progress);
  const vehicle::VehicleAnalysis analysis = vehicle::identify(drive.study, progress);
  if (analysis.interrupted) throw Interrupted();
  publish_drive(run, folder, drive, analysis);
  return kDone;
}

Command identify_command() {
  return {.name = "identify",
          .summary = "from recording to parameters, validation and report",
          .arguments = {{.name = "STUDY",
                         .help = "study file (TOML) of an aircraft's flight, a vehicle's drive, a swing test or a "
                                 "calibration; `veridyn init` writes one to start from. Studies of muscles (`model` in "
                                 "[subject]) are for `veridyn simulate`: estimating muscle parameters is not there yet",
                         .required = true}},
          .default_out = "out/identify",
          .example = "veridyn identify study.toml --out out/flight7 --set data.from=120",
          .run = [](const Arguments& arguments) { return run_on_study("identify", arguments); }};
}

}  // namespace veridyn::app
