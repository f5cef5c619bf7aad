// veridyn simulate STUDY of a musculoskeletal model: forward and inverse dynamics, static optimization, computed muscle
// control.
#include "apps/veridyn/simulate_muscle.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/veridyn/output.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/muscle/muscle_run.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/muscle_report.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::muscle;

/// Writes the files; their names, for people.
std::string write_results(const std::filesystem::path& folder, const MuscleStudy& study, const MuscleResult& result) {
  make_folder(folder);
  io::write_csv(motion_table(study, result), folder / "motion.csv");
  io::write_csv(muscle_table(study, result), folder / "muscles.csv");
  io::write_storage(state_storage(study, result), folder / "states.sto");
  std::string names = "motion.csv, muscles.csv, states.sto";
  if (const auto controls = control_storage(study, result)) {
    io::write_storage(*controls, folder / "controls.sto");
    names += ", controls.sto";
  }
  study.file->write(study.written, folder / "model.osim");
  report::write_html(report::muscle_report(study, result, "veridyn " VERIDYN_VERSION), folder / "report.html");
  return names + ", model.osim, report.html";
}

nlohmann::ordered_json summary_of(const std::filesystem::path& folder, const MuscleStudy& study,
                                  const MuscleResult& result) {
  const Model& model = study.system->model();
  const MuscleTrajectory& t = result.trajectory;
  nlohmann::ordered_json s;
  s["folder"] = folder.string();
  s["model"] = study.model_name;
  s["method"] = method_name(study.method);
  s["completed"] = result.usable();
  s["message"] = t.message();
  s["end_time_s"] = t.end_time;
  s["rows"] = t.time.size();
  s["steps"] = t.steps;
  s["evaluations"] = t.evaluations;
  s["coordinates"] = nlohmann::ordered_json::object();
  for (std::size_t c = 0; c < model.coordinates.size() && t.q.rows() > 0; ++c) {
    const auto i = static_cast<Eigen::Index>(c);
    nlohmann::ordered_json k = {{"unit", model.coordinates[c].unit()},
                                {"begin", t.q(0, i)},
                                {"end", t.q(t.q.rows() - 1, i)},
                                {"low", t.q.col(i).minCoeff()},
                                {"high", t.q.col(i).maxCoeff()}};
    if (study.method == MuscleMethod::kComputedMuscleControl) k["tracking_error"] = result.tracking_error(c);
    s["coordinates"][model.coordinates[c].name] = std::move(k);
  }
  s["muscles"] = nlohmann::ordered_json::object();
  for (std::size_t m = 0; m < model.muscles.size() && t.tendon_force.rows() > 0; ++m) {
    const auto i = static_cast<Eigen::Index>(m);
    s["muscles"][model.muscles[m].name()] = {{"peak_force_N", t.tendon_force.col(i).maxCoeff()},
                                             {"peak_activation", t.activation.col(i).maxCoeff()}};
  }
  s["events"] = nlohmann::ordered_json::array();
  for (const MuscleEvent& event : t.events) {
    s["events"].push_back({{"time_s", event.time},
                           {"muscle", model.muscles[static_cast<std::size_t>(event.muscle)].name()},
                           {"what", event_text(event.kind)}});
  }
  s["warnings"] = result.warnings;
  s["notes"] = result.notes;
  return s;
}

/// What came out, in a line.
std::string headline(const MuscleStudy& study, const MuscleResult& result) {
  const Model& model = study.system->model();
  const MuscleTrajectory& t = result.trajectory;
  std::string text;
  for (const int c : study.system->reduction().free()) {
    const Coordinate& k = model.coordinates[static_cast<std::size_t>(c)];
    const bool angle = k.motion != CoordinateMotion::kTranslational;
    const double unit = angle ? 180.0 / std::numbers::pi : 1.0;
    text += fmt::format("{}{} {:.4g} to {:.4g} {}", text.empty() ? "" : ", ", k.name, unit * t.q(0, c),
                        unit * t.q(t.q.rows() - 1, c), angle ? "deg" : "m");
    if (study.method == MuscleMethod::kComputedMuscleControl) {
      text += fmt::format(" (within {:.2g} {} of the wish)", unit * result.tracking_error(static_cast<std::size_t>(c)),
                          angle ? "deg" : "m");
    }
    if (text.size() > 400) {
      text += ", ...";
      break;
    }
  }
  return text;
}

}  // namespace

int simulate_muscle(const Study& study, const std::string& path, const CommonOptions& options,
                    const std::string& verb) {
  TerminalProgress progress(options.quiet);
  const MuscleStudy muscles = read_study(study, progress);
  const MuscleResult result = run_study(muscles, progress);
  if (result.trajectory.end == SimulationEnd::kInterrupted) {
    fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
    return kFailed;
  }
  const std::filesystem::path folder = options.out;
  progress.stage("writing the results");
  const std::string files = write_results(folder, muscles, result);
  RunRecord run{verb, study.name(), study.to_toml(), 1, muscles.inputs};
  run.inputs.emplace_back(path);
  write_run_record(folder, run, options);
  for (const std::string& warning : result.warnings) tell(options, "warning: " + warning);
  print_summary(summary_of(folder, muscles, result), options);
  if (!result.usable()) {
    fmt::print(stderr, "veridyn: {}; {} up to there {} in {}: {}\n", result.trajectory.message(),
               result.trajectory.time.size() == 1 ? "the row" : fmt::format("{} rows", result.trajectory.time.size()),
               result.trajectory.time.size() == 1 ? "is" : "are", folder.string(), files);
    return kFailed;
  }
  tell(options, fmt::format("{} of {}: {}", method_name(muscles.method), muscles.title, headline(muscles, result)));
  tell(options, fmt::format("wrote {} in {}", files, folder.string()));
  return kDone;
}

}  // namespace veridyn::app
