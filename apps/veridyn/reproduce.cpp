// veridyn reproduce aircraft|vehicle: published results beside ours, one study a row.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/veridyn/output.hpp"
#include "apps/veridyn/reproduce_studies.hpp"
#include "veridyn/aircraft/reproduction/reproduction.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/numerics/parallel.hpp"
#include "veridyn/report/aircraft_reproduction.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/vehicle_reproduction_report.hpp"

namespace veridyn::app {
namespace {

struct Options {
  std::vector<std::string> only;
  std::string studies;
  CommonOptions common;
};

struct NamedStudy {
  std::string name;
  std::string text;
};

/// The studies built into the program, or those of a folder.
std::vector<NamedStudy> studies_of(const Options& options, std::span<const EmbeddedText> embedded) {
  std::vector<NamedStudy> studies;
  if (options.studies.empty()) {
    for (const EmbeddedText& study : embedded) studies.push_back({std::string(study.name), std::string(study.text)});
  } else {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(options.studies)) {
      if (entry.path().extension() == ".toml") paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());
    for (const auto& path : paths) studies.push_back({path.stem().string(), read_file(path)});
    if (studies.empty()) throw InputError(options.studies, "holds no study (*.toml)");
  }
  if (options.only.empty()) return studies;
  std::vector<NamedStudy> chosen;
  for (const std::string& name : options.only) {
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

/// Runs every study by `run` (nothing: interrupted), tells what was seen and writes the report.
template <typename Run>
int reproduce(const Options& options, const std::string& domain, std::span<const EmbeddedText> embedded,
              const Run& run) {
  numerics::set_default_threads(options.common.threads);
  std::vector<std::string> overrides = options.common.overrides;
  if (options.common.seed) overrides.push_back(fmt::format("seed={}", *options.common.seed));
  const std::vector<NamedStudy> studies = studies_of(options, embedded);
  TerminalProgress progress(options.common.quiet);
  std::vector<report::ReproducedRow> rows;
  nlohmann::ordered_json summary = {{"rows", nlohmann::ordered_json::array()}};
  std::string run_toml;
  for (const NamedStudy& named : studies) {
    const Study study = Study::parse(named.text, named.name + ".toml", {}, overrides);
    run_toml += fmt::format("# {}\n{}\n", named.name, study.to_toml());
    const std::optional<report::ReproducedRow> row = run(study.root(), progress);
    if (!row) {
      fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
      return kFailed;
    }
    tell(options.common, fmt::format("{:<4} {}", row->passed() ? "ok" : "NO", row->title));
    nlohmann::ordered_json json = {{"row", named.name}, {"title", row->title}, {"passed", row->passed()}};
    for (const Check& check : row->checks) {
      tell(options.common, fmt::format("       {} {}", check.passed ? "+" : "-", check.text));
      json["checks"].push_back({{"passed", check.passed}, {"text", check.text}});
    }
    summary["rows"].push_back(std::move(json));
    rows.push_back(*row);
  }
  const std::filesystem::path folder = options.common.out;
  make_folder(folder);
  report::write_html(report::reproduction_report(domain, rows, "veridyn " VERIDYN_VERSION), folder / "report.html");
  summary["folder"] = folder.string();
  write_file(folder / "reproduction.json", summary.dump(2) + "\n");
  write_run_record(folder, {"reproduce", domain, run_toml, options.common.seed.value_or(0), {}}, options.common);
  tell(options.common, fmt::format("report: {}", (folder / "report.html").string()));
  print_summary(summary, options.common);
  return std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.passed(); }) ? kDone : kFailed;
}

std::optional<report::ReproducedRow> run_aircraft(const StudyTable& root, Progress& progress) {
  const aircraft::Reproduction row = aircraft::reproduce(root, progress);
  if (row.interrupted) return std::nullopt;
  return report::reproduced_row(row);
}

std::optional<report::ReproducedRow> run_vehicle(const StudyTable& root, Progress& progress) {
  const vehicle::VehicleReproduction row = vehicle::reproduce_vehicle(root, progress);
  if (row.analysis.interrupted) return std::nullopt;
  root.finish();
  return report::reproduced_row(row);
}

}  // namespace

void add_reproduce(CLI::App& program, int& exit_code) {
  CLI::App* verb = program.add_subcommand("reproduce", "published results beside ours, in one report");
  verb->require_subcommand(1);
  const auto add = [&](const std::string& domain, const std::string& help, const std::string& example, auto studies,
                       auto run) {
    auto options = std::make_shared<Options>();
    CLI::App* kind = verb->add_subcommand(domain, help);
    kind->add_option("--only", options->only, "rows whose name holds this text (repeatable)")->type_name("TEXT");
    kind->add_option("--studies", options->studies, "folder of studies to run instead of the built-in ones")
        ->check(CLI::ExistingDirectory)
        ->type_name("DIR");
    add_common(*kind, options->common, "out/reproduce", fmt::format("veridyn reproduce {} --only {}", domain, example));
    kind->callback([=, &exit_code] { exit_code = reproduce(*options, domain, studies(), run); });
  };
  add("aircraft", "regression, total least squares, recursion, stall: eleven rows", "Cm_change", aircraft_studies,
      run_aircraft);
  add("vehicle", "a car and its model of one fifth the size: four rows", "bicycle", vehicle_studies, run_vehicle);
}

}  // namespace veridyn::app
