#include "veridyn/report/muscle_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/report/figures/skeleton_figure.hpp"
#include "veridyn/report/parts/remarks.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::muscle;

/// More lines than this in one panel cannot be read: the strongest muscles, the coordinates that move most.
constexpr std::size_t kMostLines = 12;

/// View of a study and its result, both of which must outlive it, and which muscles and coordinates figures show.
struct Shown {
  const MuscleStudy& study;
  const MuscleResult& result;
  const Model& model;
  std::vector<std::size_t> muscles;      ///< drawn, in the model's order
  std::vector<std::size_t> coordinates;  ///< drawn: those that move
};

double unit_of(const Coordinate& c) { return c.motion == CoordinateMotion::kTranslational ? 1.0 : 1.0 / kDegree; }
std::string unit_name(const Coordinate& c) { return c.motion == CoordinateMotion::kTranslational ? "m" : "deg"; }
std::string force_unit(const Coordinate& c) { return c.unit() == "m" ? "N" : "N m"; }

std::vector<double> column(const estimation::RowMatrix& matrix, std::size_t index, double scale = 1.0) {
  std::vector<double> values(static_cast<std::size_t>(matrix.rows()));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) values[i] = scale * matrix(i, index);
  return values;
}

bool any(const estimation::RowMatrix& matrix) { return matrix.size() > 0 && !matrix.isZero(0.0); }

/// The `most` indices of the largest sizes, ascending.
std::vector<std::size_t> largest(const std::vector<double>& size, std::size_t most) {
  std::vector<std::size_t> index(size.size());
  std::iota(index.begin(), index.end(), std::size_t{0});
  std::stable_sort(index.begin(), index.end(), [&](std::size_t a, std::size_t b) { return size[a] > size[b]; });
  if (index.size() > most) index.resize(most);
  std::sort(index.begin(), index.end());
  return index;
}

Shown choose(const MuscleStudy& study, const MuscleResult& result) {
  Shown shown{study, result, study.system->model(), {}, {}};
  const MuscleTrajectory& t = result.trajectory;
  std::vector<double> force(shown.model.muscles.size());
  for (std::size_t m = 0; m < force.size() && t.tendon_force.rows() > 0; ++m)
    force[m] = t.tendon_force.col(m).maxCoeff();
  shown.muscles = largest(force, kMostLines);
  std::vector<double> travel(shown.model.coordinates.size());
  for (std::size_t c = 0; c < travel.size(); ++c) {
    const auto q = t.q.col(c);
    travel[c] = q.maxCoeff() - q.minCoeff();
  }
  shown.coordinates = largest(travel, kMostLines);
  std::erase_if(shown.coordinates, [&](std::size_t c) { return travel[c] < 1e-9; });
  return shown;
}

/// All names, or how many and the first ones.
std::string list_text(const std::vector<std::string>& names) {
  constexpr std::size_t kMostNames = 6;
  if (names.empty()) return "none";
  if (names.size() <= kMostNames) return fmt::format("{}", fmt::join(names, ", "));
  return fmt::format("{}: {}, ...", names.size(), fmt::join(names.begin(), names.begin() + kMostNames, ", "));
}

std::string paths_text(const MusculoskeletalSystem& system) {
  switch (system.path_source()) {
    case PathSource::kExact: {
      const std::vector<Muscle>& muscles = system.model().muscles;
      if (!muscles.empty() && std::all_of(muscles.begin(), muscles.end(), [](const Muscle& m) { return !!m.function; }))
        return "functions of coordinates, as the model gives them";
      return "wrapped at every pose, taut and continuous";
    }
    case PathSource::kFitted: {
      double length = 0.0, arm = 0.0;
      bool any = false;
      for (const PathFitError& error : system.fit()->errors()) {
        if (!error.fitted) continue;
        any = true;
        length = std::max(length, error.length);
        arm = std::max(arm, error.moment_arm);
      }
      if (!any) return "wrapped at every pose: no fit is good enough";
      return fmt::format("fitted to the wrapped paths: lengths within {:.2g} mm, moment arms {:.2g} mm", 1e3 * length,
                         1e3 * arm);
    }
    case PathSource::kAsOpenSim:
      break;
  }
  return "OpenSim's wrapping, jumps included";
}

std::vector<Fact> facts(const Shown& shown) {
  const MuscleStudy& study = shown.study;
  const CoordinateReduction& reduction = study.system->reduction();
  std::vector<std::string> free, held, coupled;
  for (std::size_t c = 0; c < shown.model.coordinates.size(); ++c) {
    const CoordinateRole role = reduction.role(static_cast<int>(c));
    (role == CoordinateRole::kFree     ? free
     : role == CoordinateRole::kDriven ? held
                                       : coupled)
        .push_back(shown.model.coordinates[c].name);
  }
  std::vector<Fact> list{{"Model", std::filesystem::path(study.model_name).filename().string()},
                         {"Method", std::string(method_name(study.method))}};
  list.push_back({"Time", fmt::format("{:g} .. {:g} s, {:g} rows a second", study.begin, study.end, study.rate_Hz)});
  list.push_back({"Free coordinates", list_text(free)});
  if (!held.empty()) list.push_back({"Locked", list_text(held)});
  if (!coupled.empty()) list.push_back({"Coupled", list_text(coupled)});
  list.push_back({"Muscles", std::to_string(shown.model.muscles.size())});
  list.push_back({"Paths", paths_text(*study.system)});
  for (const HeldLoad& load : study.loads) {
    list.push_back({"Load", fmt::format("{:g} kg on {} at ({:g}, {:g}, {:g}) m", load.mass, load.body,
                                        load.location.x(), load.location.y(), load.location.z())});
  }
  if (study.motion.external) {
    std::vector<std::string> loads;
    for (const ExternalLoad& load : study.motion.external->loads)
      loads.push_back(fmt::format("{} on {}", load.name, shown.model.bodies[load.body].name));
    list.push_back({"External loads", list_text(loads)});
  }
  const MuscleTrajectory& t = shown.result.trajectory;
  if (t.steps > 0) {
    list.push_back({"Integration",
                    fmt::format("accuracy {:g}: {} steps, {} evaluations", study.accuracy, t.steps, t.evaluations)});
  }
  return list;
}

Verdict verdict(const Shown& shown) {
  const MuscleResult& result = shown.result;
  const MuscleTrajectory& t = result.trajectory;
  Verdict v;
  if (!result.usable()) {
    v.level = Level::kBad;
    v.word = "Not finished";
    v.headline = t.message() + ".";
    v.lines.push_back(fmt::format("What follows is the motion up to there: {} rows.", t.time.size()));
    return v;
  }
  const bool clean = result.warnings.empty();
  v.level = clean ? Level::kGood : Level::kCaution;
  switch (shown.study.method) {
    case MuscleMethod::kForward:
      v.word = "Simulated";
      break;
    case MuscleMethod::kInverseDynamics:
      v.word = "Computed";
      break;
    case MuscleMethod::kStaticOptimization:
      v.word = clean ? "Balanced" : "Not all balanced";
      break;
    case MuscleMethod::kComputedMuscleControl:
      v.word = clean ? "Followed" : "Followed with help";
      break;
  }
  for (const std::size_t c : shown.coordinates) {
    const Coordinate& k = shown.model.coordinates[c];
    std::string line = fmt::format("{} goes from {:.3g} to {:.3g} {}", k.name, unit_of(k) * t.q(0, c),
                                   unit_of(k) * t.q(t.q.rows() - 1, c), unit_name(k));
    if (shown.study.method == MuscleMethod::kComputedMuscleControl) {
      line += fmt::format(", at most {:.2g} {} from the desired motion", unit_of(k) * result.tracking_error(c),
                          unit_name(k));
    }
    v.lines.push_back(line + ".");
    if (v.lines.size() >= 4) break;
  }
  const std::size_t muscles = shown.model.muscles.size();
  const double span = shown.study.end - shown.study.begin;
  switch (shown.study.method) {
    case MuscleMethod::kForward:
      v.headline = fmt::format("{} muscles moved the model for {:g} s.", muscles, span);
      break;
    case MuscleMethod::kInverseDynamics:
      v.headline = fmt::format("These forces make the desired motion of {:g} s.", span);
      break;
    case MuscleMethod::kStaticOptimization:
      v.headline = result.overloaded.empty()
                       ? fmt::format("{} muscles make the forces that {:g} s of motion need.", muscles, span)
                       : fmt::format("{} of {} frames need more than muscles and reserves have.",
                                     result.overloaded.size(), t.time.size());
      break;
    case MuscleMethod::kComputedMuscleControl:
      v.headline =
          result.overloaded.empty()
              ? fmt::format("{} muscles follow the desired motion of {:g} s.", muscles, span)
              : fmt::format("{} muscles follow the desired motion of {:g} s with help of the reserves.", muscles, span);
      break;
  }
  if (const auto& fit = result.external_fit; fit && fit->coordinate >= 0)
    v.lines.push_back(fmt::format(
        "With the external loads {} lacks {:.3g} N ({:.2g} % of the weight), without them {:.3g} N (root mean "
        "squares).",
        shown.model.coordinates[fit->coordinate].name, fit->with, 100.0 * fit->with / fit->weight, fit->without));
  if (!t.events.empty())
    v.lines.push_back(
        fmt::format("{} times a tendon went slack or a fibre reached its least length.", t.events.size()));
  return v;
}

TimeSeries motion_figure(const Shown& shown) {
  const MuscleTrajectory& t = shown.result.trajectory;
  TimeSeries figure{.title = "Motion", .samples = t.time};
  const bool follows = shown.study.method == MuscleMethod::kComputedMuscleControl;
  if (follows) figure.caption = "Dashed: the desired motion.";
  for (const std::size_t c : shown.coordinates) {
    const Coordinate& k = shown.model.coordinates[c];
    Panel panel{.label = k.name, .unit = unit_name(k)};
    if (follows)
      panel.lines.push_back(
          {.name = "desired", .y = column(shown.result.desired, c, unit_of(k)), .role = Role::kReference});
    panel.lines.push_back({.name = "motion", .y = column(t.q, c, unit_of(k))});
    figure.panels.push_back(std::move(panel));
  }
  for (const std::size_t c : shown.coordinates) {
    const Coordinate& k = shown.model.coordinates[c];
    if (shown.coordinates.size() > 4) break;
    figure.panels.push_back({.label = k.name + " speed",
                             .unit = unit_name(k) + "/s",
                             .lines = {{.name = "motion", .y = column(t.qdot, c, unit_of(k))}},
                             .height = 110});
  }
  return figure;
}

TimeSeries force_figure(const Shown& shown) {
  const MuscleTrajectory& t = shown.result.trajectory;
  TimeSeries figure{.title = "Generalised forces", .samples = t.time};
  const bool required = shown.result.generalized_force.size() > 0, reserve = any(t.reserve);
  figure.caption = required && reserve
                       ? "Required: by gravity and inertia, less external loads. Reserve: what the muscles do not give."
                   : required ? "What gravity and inertia require less external loads, without regard to constraints."
                              : "What reserve actuators add to the muscles.";
  for (std::size_t c = 0; c < shown.model.coordinates.size() && figure.panels.size() < kMostLines; ++c) {
    const Coordinate& k = shown.model.coordinates[c];
    Panel panel{.label = k.name, .unit = force_unit(k), .lines = {}, .height = 120};
    if (required) panel.lines.push_back({.name = "required", .y = column(shown.result.generalized_force, c)});
    const bool acts = reserve && !t.reserve.col(c).isZero(0.0);
    if (acts) panel.lines.push_back({.name = "reserve", .y = column(t.reserve, c)});
    if (!panel.lines.empty()) figure.panels.push_back(std::move(panel));
  }
  return figure;
}

/// Size of the force that each joint transmits, of the largest ones.
TimeSeries reaction_figure(const Shown& shown) {
  const JointReactions& reactions = *shown.result.reactions;
  TimeSeries figure{.title = "Joint reactions over time", .samples = shown.result.trajectory.time};
  std::vector<std::vector<double>> force(reactions.joints.size());
  std::vector<double> peak;
  for (std::size_t k = 0; k < force.size(); ++k) {
    for (Eigen::Index i = 0; i < reactions.force.rows(); ++i)
      force[k].push_back(reactions.force.row(i).segment(3 * signed_index(k), 3).norm());
    peak.push_back(force[k].empty() ? 0.0 : *std::max_element(force[k].begin(), force[k].end()));
  }
  Panel panel{.label = "force", .unit = "N", .lines = {}, .height = 170};
  for (const std::size_t k : largest(peak, kMostLines))
    panel.lines.push_back({.name = shown.model.joints[reactions.joints[k]].name, .y = force[k]});
  figure.panels.push_back(std::move(panel));
  return figure;
}

Table reaction_table_of(const Shown& shown) {
  const JointReactions& reactions = *shown.result.reactions;
  double weight = 0.0;
  for (const Body& body : shown.model.bodies) weight += body.mass * shown.model.gravity.norm();
  const bool muscles = shown.result.trajectory.tendon_force.size() > 0;
  Table table{.title = "Joint reactions",
              .caption = fmt::format("Force and moment on the child body, about the joint{}.",
                                     muscles ? "" : "; net, without the forces of muscles"),
              .columns = {{.name = "Joint"},
                          {.name = "force", .unit = "N", .group = "greatest"},
                          {.name = "of the weight", .unit = "%", .digits = 3, .group = "greatest"},
                          {.name = "moment", .unit = "N m", .group = "greatest"}}};
  for (std::size_t k = 0; k < reactions.joints.size(); ++k) {
    double force = 0.0, moment = 0.0;
    for (Eigen::Index i = 0; i < reactions.force.rows(); ++i) {
      force = std::max(force, reactions.force.row(i).segment(3 * signed_index(k), 3).norm());
      moment = std::max(moment, reactions.moment.row(i).segment(3 * signed_index(k), 3).norm());
    }
    table.rows.push_back({.cells = {text_cell(shown.model.joints[reactions.joints[k]].name), number_cell(force),
                                    number_cell(weight > 0.0 ? 100.0 * force / weight : 0.0), number_cell(moment)}});
  }
  return table;
}

TimeSeries muscle_figure(const Shown& shown) {
  const MuscleTrajectory& t = shown.result.trajectory;
  TimeSeries figure{.title = "Muscles over time", .samples = t.time};
  figure.caption = "Fibre lengths in optimal lengths L0: active force is greatest at 1.";
  if (shown.muscles.size() < shown.model.muscles.size())
    figure.caption += fmt::format(" The {} strongest of {} muscles.", shown.muscles.size(), shown.model.muscles.size());
  const auto panel = [&](const char* label, const char* unit, const estimation::RowMatrix& values, int height,
                         const auto& scale) {
    if (values.size() == 0) return;
    Panel p{.label = label, .unit = unit, .lines = {}, .height = height};
    for (const std::size_t m : shown.muscles)
      p.lines.push_back({.name = shown.model.muscles[m].name(), .y = column(values, m, scale(m))});
    figure.panels.push_back(std::move(p));
  };
  const auto one = [](std::size_t) { return 1.0; };
  panel("excitation", "", t.excitation, 150, one);
  panel("activation", "", t.activation, 150, one);
  panel("fibre length", "L0", t.fiber_length, 170,
        [&](std::size_t m) { return 1.0 / shown.model.muscles[m].parameters.musculotendon.optimal_fiber_length; });
  panel("tendon force", "N", t.tendon_force, 170, one);
  panel("path length", "m", t.path_length, 130, one);
  return figure;
}

const char* type_name(const MuscleParameters& muscle) {
  struct Names {
    const char* operator()(const ThelenCurves&) const { return "Thelen 2003"; }
    const char* operator()(const DeprecatedThelenCurves&) const { return "Thelen 2003 (before 2012)"; }
    const char* operator()(const SchutteCurves&) const { return "Schutte 1993"; }
    const char* operator()(const MillardCurves&) const { return "Millard 2012"; }
    const char* operator()(const DeGrooteFregly2016Curves&) const { return "De Groote-Fregly 2016"; }
  };
  return std::visit(Names(), muscle.curves);
}

Table muscle_table_of(const Shown& shown) {
  const MuscleTrajectory& t = shown.result.trajectory;
  const bool forces = t.tendon_force.size() > 0, fibers = t.fiber_length.size() > 0;
  Table table{.title = "Muscles",
              .caption =
                  "F0 maximum isometric force, L0 optimal fibre length, LS tendon slack length, pennation at "
                  "optimal length. A margin marks muscles with parameters set by the study.",
              .columns = {{.name = "Muscle"},
                          {.name = "Model"},
                          {.name = "F0", .unit = "N"},
                          {.name = "L0", .unit = "m"},
                          {.name = "LS", .unit = "m"},
                          {.name = "Pennation", .unit = "deg", .digits = 3}}};
  if (forces) {
    table.columns.push_back({.name = "force", .unit = "N", .group = "peak"});
    table.columns.push_back({.name = "of F0", .unit = "%", .digits = 3, .group = "peak"});
    table.columns.push_back({.name = "mean", .digits = 3, .group = "activation"});
    table.columns.push_back({.name = "greatest", .digits = 3, .group = "activation"});
  }
  if (fibers) {
    table.columns.push_back({.name = "least", .unit = "L0", .digits = 3, .group = "fibre length"});
    table.columns.push_back({.name = "greatest", .unit = "L0", .digits = 3, .group = "fibre length"});
  }
  for (std::size_t m = 0; m < shown.model.muscles.size(); ++m) {
    const MuscleParameters& p = shown.model.muscles[m].parameters;
    const MusculotendonParameters<double>& k = p.musculotendon;
    Row row{.cells = {text_cell(p.name),
                      text_cell(std::string(type_name(p)) + (p.rigid_tendon ? ", rigid tendon" : "")),
                      number_cell(k.max_isometric_force), number_cell(k.optimal_fiber_length),
                      number_cell(k.tendon_slack_length), number_cell(k.pennation_angle_at_optimal / kDegree)}};
    if (forces) {
      const double peak = t.tendon_force.col(m).maxCoeff();
      for (const double value :
           {peak, 100.0 * peak / k.max_isometric_force, t.activation.col(m).mean(), t.activation.col(m).maxCoeff()}) {
        row.cells.push_back(number_cell(value));
      }
    }
    if (fibers) {
      row.cells.push_back(number_cell(t.fiber_length.col(m).minCoeff() / k.optimal_fiber_length));
      row.cells.push_back(number_cell(t.fiber_length.col(m).maxCoeff() / k.optimal_fiber_length));
    }
    if (std::any_of(shown.study.changes.begin(), shown.study.changes.end(),
                    [&](const ParameterChange& c) { return c.muscle == p.name; }))
      row.status = Status::kCaution;
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table change_table(const MuscleStudy& study) {
  Table table{.title = "Parameters set by the study",
              .columns = {{.name = "Muscle"}, {.name = "Parameter"}, {.name = "In the file"}, {.name = "Here"}}};
  for (const ParameterChange& c : study.changes) {
    table.rows.push_back(
        {.cells = {text_cell(c.muscle), text_cell(c.parameter), number_cell(c.before), number_cell(c.after)}});
  }
  return table;
}

Table event_table(const Shown& shown) {
  constexpr std::size_t kMostEvents = 200;
  const std::vector<MuscleEvent>& events = shown.result.trajectory.events;
  Table table{.title = "Events",
              .columns = {{.name = "Time", .unit = "s", .digits = 5}, {.name = "Muscle"}, {.name = "What"}}};
  if (events.size() > kMostEvents) table.caption = fmt::format("The first {} of {}.", kMostEvents, events.size());
  for (std::size_t i = 0; i < std::min(events.size(), kMostEvents); ++i) {
    table.rows.push_back(
        {.cells = {number_cell(events[i].time), text_cell(shown.model.muscles[events[i].muscle].name()),
                   text_cell(event_text(events[i].kind))}});
  }
  return table;
}

std::vector<std::string> notes(const Shown& shown) {
  std::vector<std::string> list = shown.result.notes;
  for (const UnsupportedElement& u : shown.model.unsupported) {
    if (!u.changes_motion)
      list.push_back(fmt::format("{} '{}' of the file is not used; it does not change the motion", u.element, u.name));
  }
  for (const std::string& warning : shown.model.warnings) list.push_back(warning);
  const bool ellipsoid = std::any_of(shown.model.wrap_objects.begin(), shown.model.wrap_objects.end(),
                                     [](const WrapObject& w) { return w.shape == WrapShape::kEllipsoid; });
  if (ellipsoid && shown.study.system->path_source() != PathSource::kAsOpenSim) {
    list.emplace_back(
        "Paths wrap over ellipsoids. OpenSim's lengths jump at some poses there, by centimetres where its path "
        "takes "
        "the other side of the object; the paths here stay continuous, and their moment arms are -dL/dq. paths = "
        "\"opensim\" gives OpenSim's, for comparison.");
  }
  if (!shown.study.loads.empty()) list.emplace_back("model.osim does not hold the loads: they belong to the study.");
  if (shown.study.method == MuscleMethod::kComputedMuscleControl) {
    list.emplace_back(
        "Controls are held over each window. controls.sto has both ends of each window, so that this program with "
        "interpolation = \"hold\" and OpenSim, which interpolates, get the same excitations.");
  }
  return list;
}

}  // namespace

Document muscle_report(const MuscleStudy& study, const MuscleResult& result, const std::string& program) {
  const Shown shown = choose(study, result);
  Document document = started_document(
      study.title, fmt::format("Musculoskeletal model {}: {}", shown.model.name, method_name(study.method)), program);
  document.verdict = verdict(shown);
  document.facts = facts(shown);
  add_warnings(document, result.warnings);
  Section motion{.title = "Motion", .id = "motion"};
  for (XYPlot& plot : skeleton_figure(study, result)) motion.blocks.emplace_back(std::move(plot));
  if (!shown.coordinates.empty()) motion.blocks.emplace_back(motion_figure(shown));
  if (result.generalized_force.size() > 0 || any(result.trajectory.reserve))
    motion.blocks.emplace_back(force_figure(shown));
  if (result.reactions) {
    motion.blocks.emplace_back(reaction_figure(shown));
    motion.blocks.emplace_back(reaction_table_of(shown));
  }
  document.sections.push_back(std::move(motion));
  if (!shown.model.muscles.empty()) {
    Section muscles{.title = "Muscles", .id = "muscles"};
    muscles.blocks.emplace_back(muscle_figure(shown));
    muscles.blocks.emplace_back(muscle_table_of(shown));
    if (!study.changes.empty()) muscles.blocks.emplace_back(change_table(study));
    if (!result.trajectory.events.empty()) muscles.blocks.emplace_back(event_table(shown));
    document.sections.push_back(std::move(muscles));
  }
  add_notes(document, notes(shown));
  if (!shown.model.credits.empty()) {
    Section section{.title = "Credits of the model", .id = "credits", .folded = true};
    section.blocks.emplace_back(Paragraph{.text = shown.model.credits});
    document.sections.push_back(std::move(section));
  }
  return document;
}

}  // namespace veridyn::report
