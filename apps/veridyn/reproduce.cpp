// veridyn reproduce aircraft|vehicle|muscle|cueing: published results alongside ours, one study per row.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "apps/veridyn/reproduce_studies.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "bench/reproduction/aircraft/reproduction.hpp"
#include "bench/reproduction/report/aircraft_reproduction_report.hpp"
#include "bench/reproduction/report/cueing_reproduction_report.hpp"
#include "bench/reproduction/report/muscle_reproduction_report.hpp"
#include "bench/reproduction/report/vehicle_reproduction_report.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/report/document/html.hpp"

namespace veridyn::app {
namespace {

struct NamedStudy {
  std::string name;
  std::string text;
};

/// The studies built into the program, or those of a folder.
std::vector<NamedStudy> studies_of(const Arguments& arguments, std::span<const EmbeddedText> embedded) {
  const std::string& folder = arguments.text("--studies");
  const std::vector<std::string>& only = arguments.texts("--only");
  std::vector<NamedStudy> studies;
  if (folder.empty()) {
    for (const EmbeddedText& study : embedded) studies.push_back({std::string(study.name), std::string(study.text)});
  } else {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".toml") paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());
    for (const auto& path : paths) studies.push_back({path.stem().string(), read_file(path)});
    if (studies.empty()) throw InputError(folder, "holds no study (*.toml)");
  }
  if (only.empty()) return studies;
  std::vector<NamedStudy> chosen;
  for (const std::string& name : only) {
    const std::size_t before = chosen.size();
    for (const NamedStudy& study : studies) {
      if (study.name.find(name) != std::string::npos) chosen.push_back(study);
    }
    if (chosen.size() == before) {
      std::vector<std::string> names;
      for (const NamedStudy& study : studies) names.push_back(study.name);
      throw InputError("--only", fmt::format("no row is called '{}'{}", name, suggestion(name, names)));
    }
  }
  return chosen;
}

using Run = std::optional<report::ReproducedRow> (*)(const Study& study, Progress& progress);

/// Runs every study by `run` (nothing: interrupted), prints the rows and writes the report.
int reproduce(const Arguments& arguments, const std::string& domain, std::span<const EmbeddedText> embedded, Run run) {
  const CommonOptions& options = arguments.common;
  std::vector<std::string> overrides = options.overrides;
  if (options.seed) overrides.push_back(fmt::format("seed={}", *options.seed));
  const std::vector<NamedStudy> studies = studies_of(arguments, embedded);
  OutputFolder folder(options.out);
  TerminalProgress progress = progress_of(options);
  std::vector<report::ReproducedRow> rows;
  Summary summary;
  summary["rows"] = Summary::array();
  std::string run_toml;
  for (const NamedStudy& named : studies) {
    const Study study = Study::parse(named.text, named.name + ".toml", {}, overrides);
    run_toml += fmt::format("# {}\n{}\n", named.name, study.to_toml());
    const std::optional<report::ReproducedRow> row = run(study, progress);
    if (!row) throw Interrupted();
    print_line(options, fmt::format("{:<4} {}", row->passed() ? "ok" : "NO", row->title));
    if (!row->finding.empty()) print_line(options, fmt::format("       published: {}", row->finding));
    if (!row->ours.empty()) print_line(options, fmt::format("       here: {}", row->ours));
    Summary json = Summary::object({{"row", named.name},
                                    {"title", row->title},
                                    {"published", row->finding},
                                    {"here", row->ours},
                                    {"passed", row->passed()}});
    for (const CheckOutcome& check : row->checks) {
      print_line(options, fmt::format("       {} {}", check.passed ? "+" : "-", check.text));
      json["checks"].push_back(Summary::object({{"passed", check.passed}, {"text", check.text}}));
    }
    summary["rows"].push_back(std::move(json));
    rows.push_back(*row);
  }
  folder.write("report.html", report::to_html(report::reproduction_report(domain, rows, program_name())));
  summary["folder"] = folder.path().string();
  folder.write("reproduction.json", summary.to_json() + "\n");
  folder.publish({"reproduce", domain, run_toml, options.seed.value_or(0), {}}, options, summary);
  print_line(options, fmt::format("report: {}", (folder.path() / "report.html").string()));
  return std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.passed(); }) ? kDone : kFailed;
}

std::optional<report::ReproducedRow> run_aircraft(const Study& study, Progress& progress) {
  const aircraft::Reproduction row = aircraft::reproduce(study.root(), progress);
  if (row.interrupted) return std::nullopt;
  return report::reproduced_row(row);
}

std::optional<report::ReproducedRow> run_vehicle(const Study& study, Progress& progress) {
  const vehicle::VehicleReproduction row = vehicle::reproduce_vehicle(study.root(), progress);
  if (row.analysis.interrupted) return std::nullopt;
  study.root().finish();
  return report::reproduced_row(row);
}

std::optional<report::ReproducedRow> run_muscle(const Study& study, Progress& progress) {
  const muscle::MuscleReproduction row = muscle::reproduce_muscle(study, progress);
  if (row.interrupted) return std::nullopt;
  return report::reproduced_row(row);
}

std::optional<report::ReproducedRow> run_cueing(const Study& study, Progress& progress) {
  const cueing::CueingReproduction row = cueing::reproduce_cueing(study.root(), progress);
  if (row.interrupted) return std::nullopt;
  study.root().finish();
  return report::reproduced_row(row);
}

Command reproduce_domain(const std::string& domain, const std::string& summary, const std::string& example,
                         std::span<const EmbeddedText> (*studies)(), Run run) {
  return {.name = domain,
          .summary = summary,
          .arguments = {{.name = "--only",
                         .help = "rows whose name holds this text (repeatable)",
                         .value = std::vector<std::string>(),
                         .type = "TEXT"},
                        {.name = "--studies",
                         .help = "folder of studies to run instead of the built-in ones",
                         .type = "DIR",
                         .folder = true}},
          .default_out = "out/reproduce",
          .example = fmt::format("veridyn reproduce {} --only {}", domain, example),
          .run = [=](const Arguments& arguments) { return reproduce(arguments, domain, studies(), run); }};
}

}  // namespace

Command reproduce_command() {
  return {
      .name = "reproduce",
      .summary = "published results alongside ours, in one report",
      .commands = {reproduce_domain("aircraft", "regression, total least squares, recursion, stall: eleven rows",
                                    "Cm_change", aircraft_studies, run_aircraft),
                   reproduce_domain("vehicle", "a car and its model of one fifth the size: four rows", "bicycle",
                                    vehicle_studies, run_vehicle),
                   reproduce_domain("muscle", "hidden persons from one task and from several: four rows", "one_task",
                                    muscle_studies, run_muscle),
                   reproduce_domain("cueing", "ramp, false pitch, static tilt, thresholds, golden steps: seven rows",
                                    "ramp", cueing_studies, run_cueing)}};
}

}  // namespace veridyn::app
