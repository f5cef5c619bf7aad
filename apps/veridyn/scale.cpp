// veridyn scale STUDY: similarity scaling of a vehicle, and how similar a given one is.
#include <fmt/format.h>

#include <cmath>

#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/estimation/judgement/subject_grades.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/similarity_report.hpp"
#include "veridyn/vehicle/scale_study.hpp"
#include "veridyn/vehicle/simulation/trajectory_table.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::vehicle;

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

Summary summary_of(const GroupComparison& g) {
  return Summary::object({{"quantity", g.parameter},
                          {"group", g.formula},
                          {"prototype", g.prototype},
                          {"model", g.model},
                          {"mismatch_percent", g.mismatch_percent}});
}

Summary summary_of(const std::filesystem::path& folder, const ScaleAnalysis& a) {
  const SimilarityReport& r = a.judged();
  Summary s;
  s["folder"] = folder.string();
  s["factors"] = Summary::object({{"length", r.factors.length},
                                  {"mass", r.factors.mass},
                                  {"speed", r.factors.speed},
                                  {"time", r.factors.time()},
                                  {"force", r.factors.force()},
                                  {"acceleration", r.factors.acceleration()}});
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const double value = field_of(a.scaled.model.parameters, i);
    if (std::isfinite(value)) s["scaled"][kVehicleFields[i].name] = value;
  }
  s["groups"] = Summary::array();
  for (const GroupComparison& g : r.groups) s["groups"].push_back(summary_of(g));
  s["gravity"] = summary_of(r.gravity);
  s["gravity_changes"] = r.gravity_changes;
  s["similar_without_gravity"] = r.similar_without_gravity();
  s["message"] = r.message();
  return s;
}

}  // namespace

int scale_vehicle(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  TerminalProgress progress = progress_of(run.options());
  const ScaleStudy study = read_scale_study(run.study.root(), progress);
  finish_drive_study(run.study.root(), progress, DriveTables::kScale);
  progress.stage("driving prototype and models");
  const ScaleAnalysis analysis = run_scale_study(study, progress);
  if (analysis.interrupted) throw Interrupted();
  const SimilarityReport& r = analysis.judged();
  folder.write("groups.csv", groups_csv(r));
  folder.write("scaled.toml",
               write_vehicle_toml(analysis.twin) + estimation::grades_table(run.study.root().table("subject")));
  folder.write("prototype.csv", io::to_csv(to_recording(analysis.prototype)));
  folder.write("model.csv", io::to_csv(to_recording(analysis.runs.back().trajectory)));
  folder.write("report.html", report::to_html(report::similarity_report(study, analysis, program_name())));
  folder.publish(run.record(study.simulation.seed, study.simulation.inputs), run.options(),
                 summary_of(folder.path(), analysis));
  const auto print = [&](const std::string& line) { print_line(run.options(), line); };
  for (const GroupComparison& g : r.mismatches())
    print(fmt::format("  {:<22} {:+.3g} %   {}", g.formula, g.mismatch_percent, g.affects));
  print(fmt::format("  {:<22} {:+.3g} %   (gravity, separately)", r.gravity.formula, r.gravity.mismatch_percent));
  for (const std::string& line : r.gravity_changes) print("    " + line);
  for (const Vehicle* vehicle : {&study.simulation.vehicle, study.given ? &*study.given : nullptr}) {
    if (vehicle == nullptr) continue;
    for (const std::string& line : vehicle->warnings) print(fmt::format("warning: {}: {}", vehicle->name, line));
  }
  for (const std::string& line : analysis.ended_early()) print("warning: " + line);
  print(r.message());
  print(fmt::format("wrote groups.csv, scaled.toml, prototype.csv, model.csv, report.html in {}",
                    folder.path().string()));
  return kDone;
}

Command scale_command() {
  return {.name = "scale",
          .summary = "a dynamically similar scaled vehicle, and how similar a given one is",
          .arguments = {{.name = "STUDY",
                         .help = "study file (TOML) of a vehicle; [scale] says to which length, mass or speed, "
                                 "[scale.model] describes a scaled vehicle to be checked",
                         .required = true}},
          .default_out = "out/scale",
          .example = "veridyn scale car.toml --set scale.length_ratio=0.2 --set scale.mass=\"8.8 kg\"",
          .run = [](const Arguments& arguments) { return run_on_study("scale", arguments); }};
}

}  // namespace veridyn::app
