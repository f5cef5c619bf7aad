// veridyn validate STUDY --estimate-file FILE: an estimate against other data.
#include "apps/veridyn/results/aircraft_results.hpp"
#include "apps/veridyn/results/drive_results.hpp"
#include "apps/veridyn/results/muscle_results.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "veridyn/io/results/estimate_json.hpp"

namespace veridyn::app {

int validate_aircraft(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  const estimation::Estimate estimate = io::read_estimate(run.arguments.text("--estimate-file"));
  TerminalProgress progress = progress_of(run.options());
  const std::vector<aircraft::FlightStudy> flights = aircraft::read_flights(run.study, progress);
  const aircraft::FlightAnalysis analysis = aircraft::validate(flights, estimate, progress);
  if (analysis.interrupted) throw Interrupted();
  publish_identification(run, folder, flights, analysis);
  return kDone;
}

int validate_vehicle(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  const estimation::Estimate estimate = io::read_estimate(run.arguments.text("--estimate-file"));
  TerminalProgress progress = progress_of(run.options());
  PreparedDrive drive = prepare_drive(run.study, progress);
  const vehicle::VehicleAnalysis analysis = vehicle::validate(drive.study, estimate, progress);
  if (analysis.interrupted) throw Interrupted();
  publish_drive(run, folder, drive, analysis);
  return kDone;
}

int validate_muscles(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  const estimation::Estimate estimate = io::read_estimate(run.arguments.text("--estimate-file"));
  TerminalProgress progress = progress_of(run.options());
  const muscle::TaskStudy study = muscle::read_task_study(run.study, progress);
  const muscle::MuscleAnalysis analysis = muscle::validate(study, estimate, progress);
  if (analysis.interrupted) throw Interrupted();
  publish_muscles(run, folder, study, analysis);
  return kDone;
}

Command validate_command() {
  return {.name = "validate",
          .summary = "an estimate validated on held-out data: another flight or drive, other tasks",
          .arguments = {{.name = "STUDY", .help = "study file of the other flight, drive or tasks", .required = true},
                        {.name = "--estimate-file",
                         .help = "estimate.json of an identification",
                         .type = "FILE",
                         .required = true,
                         .old_name = "--estimate"}},
          .default_out = "out/validate",
          .example = "veridyn validate flight8.toml --estimate-file out/flight7/estimate.json",
          .run = [](const Arguments& arguments) { return run_on_study("validate", arguments); }};
}

}  // namespace veridyn::app
