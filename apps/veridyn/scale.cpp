// veridyn scale STUDY: similarity scaling of a vehicle, and how like the original a scaled one is.
#include "apps/veridyn/scale.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/veridyn/output.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/similarity_report.hpp"
#include "veridyn/vehicle/scale_study.hpp"
#include "veridyn/vehicle/simulation/trajectory_table.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::vehicle;

struct Options {
  std::string study;
  CommonOptions common;
};

std::string groups_csv(const SimilarityReport& r) {
  std::string text = "quantity,group,prototype,model,mismatch_percent,affects\n";
  const auto line = [&](const GroupComparison& g) {
    text += fmt::format("{},\"{}\",{},{},{},\"{}\"\n", g.parameter, g.formula, g.prototype, g.model, g.mismatch_percent,
                        g.affects);
  };
  for (const GroupComparison& g : r.groups) line(g);
  line(r.gravity);
  return text;
}

nlohmann::ordered_json summary_of(const std::filesystem::path& folder, const ScaleAnalysis& a) {
  const auto json = [](const GroupComparison& g) {
    return nlohmann::ordered_json{
        {"quantity", g.parameter},
        {"group", g.formula},
        {"prototype", g.prototype},
        {"model", g.model},
        {"mismatch_percent", std::isfinite(g.mismatch_percent) ? nlohmann::ordered_json(g.mismatch_percent)
                                                               : nlohmann::ordered_json(nullptr)}};
  };
  const SimilarityReport& r = a.judged();
  nlohmann::ordered_json s;
  s["folder"] = folder.string();
  s["factors"] = {{"length", r.factors.length}, {"mass", r.factors.mass},
                  {"speed", r.factors.speed},   {"time", r.factors.time()},
                  {"force", r.factors.force()}, {"acceleration", r.factors.acceleration()}};
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const double value = field_of(a.scaled.model.parameters, i);
    if (std::isfinite(value)) s["scaled"][kVehicleFields[i].name] = value;
  }
  s["groups"] = nlohmann::ordered_json::array();
  for (const GroupComparison& g : r.groups) s["groups"].push_back(json(g));
  s["gravity"] = json(r.gravity);
  s["gravity_changes"] = r.gravity_changes;
  s["similar_without_gravity"] = r.similar_without_gravity();
  s["message"] = r.message();
  return s;
}

}  // namespace

int scale_vehicle(const Study& study, const std::string& path, const CommonOptions& options, const std::string& verb) {
  if (!is_vehicle_study(study.root()))
    throw InputError(study.root().place("subject"), "is no vehicle: `veridyn scale` needs kind = \"vehicle\"");
  ScaleStudy scale_study = read_scale_study(study.root());
  for (const char* table : {"sensors", "data", "signals", "segments", "identify", "validate", "track"})
    static_cast<void>(study.root().has(table));
  study.root().finish();
  TerminalProgress progress(options.quiet);
  progress.stage("driving prototype and models");
  const ScaleAnalysis analysis = run_scale_study(scale_study, progress);
  if (analysis.interrupted) {
    fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
    return kFailed;
  }
  const std::filesystem::path folder = options.out;
  make_folder(folder);
  const SimilarityReport& r = analysis.judged();
  write_file(folder / "groups.csv", groups_csv(r));
  write_file(folder / "scaled.toml", write_vehicle_toml(analysis.twin));
  io::write_csv(to_recording(analysis.prototype), folder / "prototype.csv");
  io::write_csv(to_recording(analysis.runs.back().own), folder / "model.csv");
  report::write_html(report::similarity_report(scale_study, analysis, "veridyn " VERIDYN_VERSION),
                     folder / "report.html");
  RunRecord record{verb, study.name(), study.to_toml(), scale_study.simulation.seed, scale_study.simulation.inputs};
  record.inputs.emplace_back(path);
  write_run_record(folder, record, options);
  for (const GroupComparison& g : r.mismatches())
    tell(options, fmt::format("  {:<22} {:+.3g} %   {}", g.formula, g.mismatch_percent, g.affects));
  tell(options, fmt::format("  {:<22} {:+.3g} %   (gravity, apart)", r.gravity.formula, r.gravity.mismatch_percent));
  for (const std::string& line : r.gravity_changes) tell(options, "    " + line);
  for (const std::string& line : analysis.ended_early()) tell(options, "warning: " + line);
  tell(options, r.message());
  tell(options,
       fmt::format("wrote groups.csv, scaled.toml, prototype.csv, model.csv, report.html in {}", folder.string()));
  print_summary(summary_of(folder, analysis), options);
  return kDone;
}

void add_scale(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = program.add_subcommand("scale", "a vehicle of another size that moves alike, and how like one is");
  verb->add_option(
          "STUDY", options->study,
          "study file (TOML) of a vehicle; [scale] says to which length, mass or speed, [scale.model] describes "
          "a scaled vehicle to be checked")
      ->required();
  add_common(*verb, options->common, "out/scale",
             "veridyn scale car.toml --set scale.length_ratio=0.2 --set scale.mass=\"8.8 kg\"");
  verb->callback([options, &exit_code] {
    exit_code = scale_vehicle(load_study(options->study, options->common), options->study, options->common);
  });
}

}  // namespace veridyn::app
