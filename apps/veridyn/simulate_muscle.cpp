// veridyn simulate STUDY of a musculoskeletal model: forward and inverse dynamics, static optimization, computed muscle
// control.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/muscle/muscle_study.hpp"
#include "veridyn/muscle/osim/external_loads_file.hpp"
#include "veridyn/muscle/study/muscle_run.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/muscle_report.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::muscle;

void write_results(OutputFolder& folder, const MuscleStudy& study, const MuscleResult& result) {
  folder.write("motion.csv", io::to_csv(motion_table(study, result)));
  folder.write("muscles.csv", io::to_csv(muscle_table(study, result)));
  using Path = std::filesystem::path;
  folder.write("states.sto", [&](const Path& path) { io::write_storage(state_storage(study, result), path); });
  if (const auto controls = control_storage(study, result))
    folder.write("controls.sto", [&](const Path& path) { io::write_storage(*controls, path); });
  if (result.reactions) folder.write("reactions.csv", io::to_csv(reaction_table(study, result)));
  if (result.metabolic) folder.write("metabolics.csv", io::to_csv(metabolic_table(study, result)));
  if (result.induced) folder.write("induced_accelerations.csv", io::to_csv(induced_table(study, result)));
  if (const auto contacts = contact_record(study, result)) {
    folder.write("contact_forces.sto", [&](const Path& path) { io::write_storage(contacts->storage, path); });
    folder.write("contact_loads.xml", to_external_loads_text(contacts->sources, "contact_forces.sto"));
  }
  folder.write("model.osim", [&](const Path& path) { study.file->write(study.written, path); });
  folder.write("report.html", report::to_html(report::muscle_report(study, result, program_name())));
}

Summary summary_of(const std::filesystem::path& folder, const MuscleStudy& study, const MuscleResult& result) {
  const Model& model = study.system->model();
  const MuscleTrajectory& t = result.trajectory;
  Summary s;
  s["folder"] = folder.string();
  s["model"] = study.model_name;
  s["method"] = method_name(study.method);
  s["completed"] = result.usable();
  s["message"] = t.message();
  s["end_time_s"] = t.end_time;
  s["rows"] = t.time.size();
  s["steps"] = t.steps;
  s["evaluations"] = t.evaluations;
  s["coordinates"] = Summary::object();
  for (std::size_t c = 0; c < model.coordinates.size() && t.q.rows() > 0; ++c) {
    const auto i = signed_index(c);
    Summary k = Summary::object({{"unit", model.coordinates[c].unit()},
                                 {"begin", t.q(0, i)},
                                 {"end", t.q(t.q.rows() - 1, i)},
                                 {"low", t.q.col(i).minCoeff()},
                                 {"high", t.q.col(i).maxCoeff()}});
    if (study.method == MuscleMethod::kComputedMuscleControl) k["tracking_error"] = result.tracking_error(c);
    s["coordinates"][model.coordinates[c].name] = std::move(k);
  }
  s["muscles"] = Summary::object();
  for (std::size_t m = 0; m < model.muscles.size() && t.tendon_force.rows() > 0; ++m) {
    const auto i = signed_index(m);
    s["muscles"][model.muscles[m].name()] = Summary::object(
        {{"peak_force_N", t.tendon_force.col(i).maxCoeff()}, {"peak_activation", t.activation.col(i).maxCoeff()}});
  }
  if (const auto& fit = result.external_fit; fit && fit->coordinate >= 0)
    s["external_loads"] = Summary::object({{"coordinate", model.coordinates[fit->coordinate].name},
                                           {"weight_N", fit->weight},
                                           {"residual_without_N", fit->without},
                                           {"residual_with_N", fit->with},
                                           {"factor", fit->factor}});
  s["events"] = Summary::array();
  for (const MuscleEvent& event : t.events) {
    s["events"].push_back(Summary::object(
        {{"time_s", event.time}, {"muscle", model.muscles[event.muscle].name()}, {"what", event_text(event.kind)}}));
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
    const Coordinate& k = model.coordinates[c];
    const bool angle = k.motion != CoordinateMotion::kTranslational;
    const double unit = angle ? 180.0 / kPi : 1.0;
    text += fmt::format("{}{} {:.4g} to {:.4g} {}", text.empty() ? "" : ", ", k.name, unit * t.q(0, c),
                        unit * t.q(t.q.rows() - 1, c), angle ? "deg" : "m");
    if (study.method == MuscleMethod::kComputedMuscleControl) {
      text += fmt::format(" (within {:.2g} {} of the desired motion)", unit * result.tracking_error(at(c)),
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

int simulate_muscle(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  TerminalProgress progress = progress_of(run.options());
  const MuscleStudy muscles = muscle::read_study(run.study, progress);
  // Nothing here is random yet; the run record names the seed all the same.
  const auto seed = static_cast<std::uint64_t>(run.study.root().integer_or("seed", 1));
  const MuscleResult result = run_study(muscles, progress);
  const MuscleTrajectory& t = result.trajectory;
  if (t.end == muscle::MotionEnd::kInterrupted) throw Interrupted();
  progress.stage("writing the results");
  write_results(folder, muscles, result);
  const std::string files = fmt::format("{}", fmt::join(folder.files(), ", "));
  folder.publish(run.record(seed, muscles.inputs), run.options(), summary_of(folder.path(), muscles, result));
  for (const std::string& warning : result.warnings) print_line(run.options(), "warning: " + warning);
  if (!result.usable()) {
    const std::string rows =
        t.time.size() == 1 ? "the row up to there is" : fmt::format("{} rows up to there are", t.time.size());
    throw std::runtime_error(fmt::format("{}; {} in {}: {}", t.message(), rows, folder.path().string(), files));
  }
  print_line(run.options(),
             fmt::format("{} of {}: {}", method_name(muscles.method), muscles.title, headline(muscles, result)));
  print_line(run.options(), fmt::format("wrote {} in {}", files, folder.path().string()));
  return kDone;
}

}  // namespace veridyn::app
