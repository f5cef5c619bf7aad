// veridyn sensitivity STUDY of a vehicle: which of its numbers moves which metric and signal of a simulated drive.
#include <fmt/format.h>

#include <memory>

#include "apps/veridyn/results/response_results.hpp"
#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/vehicle/drive_sensitivity.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::vehicle;

PreparedResponses prepare_drive_responses(const StudyRun& run, Progress& progress) {
  const StudyTable& root = run.study.root();
  refuse_recording(root, "[drive]");
  const auto study = std::make_shared<const DriveSensitivityStudy>(read_drive_sensitivity(root, progress));
  root.table_or_empty("sensitivity").finish();
  finish_drive_study(root, progress, DriveTables::kSimulation);
  const SimulationStudy& drive = study->drive;
  const std::string what =
      fmt::format("{} of {} at {:.3g} km/h, {} model, {:g} s", to_string(drive.manoeuvre.kind), drive.vehicle.name,
                  3.6 * drive.simulation.speed, to_string(drive.model), drive.simulation.duration);
  PreparedResponses prepared{.stage = fmt::format("driving {} with {} inputs varied", what, study->inputs.size()),
                             .options = study->options,
                             .inputs = drive.inputs};
  prepared.context = {.program = program_name(),
                      .title = drive.title,
                      .subject = fmt::format("{}: sensitivity of a simulated drive", drive.vehicle.name),
                      .what = what,
                      .facts = {{"Vehicle", drive.vehicle.name},
                                {"Model", std::string(to_string(drive.model))},
                                {"Manoeuvre", std::string(to_string(drive.manoeuvre.kind))}},
                      .notes = drive.vehicle.warnings};
  prepared.context.notes.emplace_back(
      "Differences are root mean squares over the samples, from the nominal drive. A driver who follows a path expects "
      "the nominal vehicle.");
  prepared.analyse = [study](numerics::BlockStore& store, Progress& p) { return analyse_drive(*study, store, p); };
  return prepared;
}

}  // namespace

int sensitivity_vehicle(const StudyRun& run) {
  return run_responses(run, [&](Progress& progress) { return prepare_drive_responses(run, progress); });
}

}  // namespace veridyn::app
