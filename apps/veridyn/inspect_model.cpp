// veridyn inspect MODEL.osim: what a musculoskeletal model holds.
#include "apps/veridyn/inspect_model.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/simulation/pose_table.hpp"
#include "veridyn/muscle/study/model_check.hpp"

namespace veridyn::app {
namespace {

using namespace muscle;

std::string motion_name(CoordinateMotion motion) {
  switch (motion) {
    case CoordinateMotion::kRotational:
      return "rotation";
    case CoordinateMotion::kTranslational:
      return "translation";
    case CoordinateMotion::kCoupled:
      break;
  }
  return "mixed";
}

std::string type_name(const MuscleParameters& muscle) {
  struct Names {
    const char* operator()(const ThelenCurves&) const { return "Thelen2003"; }
    const char* operator()(const DeprecatedThelenCurves&) const { return "Thelen2003_Deprecated"; }
    const char* operator()(const SchutteCurves&) const { return "Schutte1993"; }
    const char* operator()(const MillardCurves&) const { return "Millard2012"; }
    const char* operator()(const DeGrooteFregly2016Curves&) const { return "DeGrooteFregly2016"; }
  };
  return std::visit(Names(), muscle.curves);
}

std::string shape_text(const WrapObject& wrap) {
  const Eigen::Vector3d& d = wrap.dimensions;
  switch (wrap.shape) {
    case WrapShape::kSphere:
      return fmt::format("sphere, radius {} m", d.x());
    case WrapShape::kCylinder:
      return fmt::format("cylinder, radius {} m, length {} m", d.x(), d.y());
    case WrapShape::kEllipsoid:
      return fmt::format("ellipsoid, radii {} {} {} m", d.x(), d.y(), d.z());
    case WrapShape::kTorus:
      break;
  }
  return fmt::format("torus, radii {} and {} m", d.x(), d.y());
}

std::string quadrant_text(const WrapQuadrant& quadrant) {
  if (quadrant.sign == 0) return "all around";
  return fmt::format("side {}{}", quadrant.sign < 0 ? '-' : '+', "xyz"[quadrant.axis]);
}

/// "locked", "coupled to knee_angle_r".
std::string coordinate_note(const Model& model, int index) {
  std::string note = model.coordinates[index].locked ? "locked" : "";
  for (const CoordinateCoupler& coupler : model.couplers) {
    if (coupler.dependent != index) continue;
    if (!note.empty()) note += ", ";
    note += "coupled to " + model.coordinates[coupler.independent].name;
  }
  return note;
}

/// Wrap objects, or the coordinates that the path's length is a function of.
std::string wraps_text(const Model& model, const Muscle& muscle) {
  std::string text;
  if (muscle.function) {
    text = "length given by";
    for (const int c : muscle.function->coordinates) text += " " + model.coordinates[c].name;
  }
  for (const PathWrap& wrap : muscle.wraps) {
    text += (text.empty() ? "" : " ") + model.wrap_objects[wrap.object].name;
  }
  return text;
}

bool is_model_folder(const std::string& folder) {
  return std::filesystem::is_directory(folder) && !model_files(folder).empty();
}

/// What becomes of every model of a folder.
int inspect_models(const std::string& folder, const CommonOptions& options) {
  TerminalProgress progress = progress_of(options);
  std::vector<ModelCheck> checks;
  for (const std::filesystem::path& file : model_files(folder)) {
    progress.stage(file.lexically_relative(folder).string());
    checks.push_back(check_model(file, progress));
  }
  Summary summary = Summary::array();
  for (const ModelCheck& c : checks)
    summary.push_back(Summary::object({{"file", c.file.string()},
                                       {"format", c.version},
                                       {"muscles", c.muscles},
                                       {"loads", c.loads},
                                       {"simulates", c.simulates},
                                       {"missing", c.missing},
                                       {"trouble", c.trouble}}));
  if (options.json) {
    print_summary(Summary::object({{"models", summary}}), options);
  } else {
    print_text(model_check_table(checks, folder));
  }
  return kDone;
}

std::string describe(const std::string& file, const Model& model) {
  const auto body = [&](int index) -> const std::string& { return model.bodies[index].name; };
  double mass = 0.0;
  for (const Body& b : model.bodies) mass += b.mass;
  std::string text = fmt::format(
      "{}: OpenSim model '{}', format {}\n{} bodies of {:.4g} kg, {} joints, {} coordinates, {} muscles, {} wrap "
      "objects, "
      "{} markers; gravity {} {} {} m/s^2\n",
      file, model.name, model.version, model.bodies.size() - 1, mass, model.joints.size(), model.coordinates.size(),
      model.muscles.size(), model.wrap_objects.size(), model.markers.size(), model.gravity.x(), model.gravity.y(),
      model.gravity.z());
  text += fmt::format("\n{:<24} {:>10} {:>28} {:>36}\n", "body", "mass [kg]", "mass centre [m]",
                      "inertia xx yy zz [kg m^2]");
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const Body& b = model.bodies[i];
    text += fmt::format("{:<24} {:>10.6g} {:>28} {:>36}\n", b.name, b.mass,
                        fmt::format("{:.5g} {:.5g} {:.5g}", b.mass_center.x(), b.mass_center.y(), b.mass_center.z()),
                        fmt::format("{:.6g} {:.6g} {:.6g}", b.inertia(0, 0), b.inertia(1, 1), b.inertia(2, 2)));
  }
  text += fmt::format("\n{:<24} {:<16} {:<24} {:<24} coordinates\n", "joint", "type", "parent", "child");
  for (const Joint& j : model.joints) {
    std::string names;
    for (const int c : j.coordinates) names += (names.empty() ? "" : " ") + model.coordinates[c].name;
    text += fmt::format("{:<24} {:<16} {:<24} {:<24} {}\n", j.name, j.type, body(j.parent), body(j.child), names);
  }
  text += fmt::format("\n{:<24} {:<12} {:>10} {:>10} {:>10}  note\n", "coordinate [rad] or [m]", "motion", "low",
                      "high", "default");
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    const Coordinate& c = model.coordinates[i];
    text += fmt::format("{:<24} {:<12} {:>10.5g} {:>10.5g} {:>10.5g}  {}\n", c.name, motion_name(c.motion), c.low,
                        c.high, c.default_value, coordinate_note(model, static_cast<int>(i)));
  }
  if (!model.muscles.empty()) {
    text += fmt::format("\n{:<20} {:<22} {:>9} {:>8} {:>8} {:>8} {:>6} {:>12} {:>6}  wraps\n", "muscle", "type",
                        "F0 [N]", "L0 [m]", "LS [m]", "phi0", "Vmax", "tau [s]", "points");
  }
  for (const Muscle& muscle : model.muscles) {
    const MuscleParameters& p = muscle.parameters;
    const MusculotendonParameters<double>& m = p.musculotendon;
    text += fmt::format("{:<20} {:<22} {:>9.2f} {:>8.5f} {:>8.5f} {:>8.4f} {:>6.2f} {:>12} {:>6}  {}{}{}\n", p.name,
                        type_name(p), m.max_isometric_force, m.optimal_fiber_length, m.tendon_slack_length,
                        m.pennation_angle_at_optimal, m.max_contraction_velocity,
                        fmt::format("{:.3g}/{:.3g}", m.activation_time_constant, m.deactivation_time_constant),
                        muscle.points.size(), wraps_text(model, muscle), p.rigid_tendon ? " (rigid tendon)" : "",
                        muscle.enabled ? "" : " (off)");
  }
  if (!model.wrap_objects.empty()) text += fmt::format("\n{:<24} {:<24} shape\n", "wrap object", "body");
  for (const WrapObject& wrap : model.wrap_objects) {
    text += fmt::format("{:<24} {:<24} {}, {}{}\n", wrap.name, body(wrap.body), shape_text(wrap),
                        quadrant_text(wrap.quadrant), wrap.active ? "" : " (off)");
  }
  for (const CoordinateActuator& a : model.actuators) {
    text += fmt::format("actuator {} on {}, optimal force {}\n", a.name, model.coordinates[a.coordinate].name,
                        a.optimal_force);
  }
  for (const CoordinateLimitForce& f : model.limit_forces) {
    text += fmt::format("limit force {} on {}\n", f.name, model.coordinates[f.coordinate].name);
  }
  for (const CoordinateSpring& f : model.coordinate_springs)
    text += fmt::format("spring {} on {}\n", f.name, model.coordinates[f.coordinate].name);
  for (const PointSpring& f : model.body_forces.springs)
    text += fmt::format("spring {} from {} to {}\n", f.name, body(f.body_1), body(f.body_2));
  for (const Bushing& f : model.body_forces.bushings)
    text += fmt::format("bushing {} from {} to {}\n", f.name, body(f.body_1), body(f.body_2));
  for (const SphereContact& f : model.body_forces.contacts)
    text +=
        fmt::format("contact {}: sphere of {}, half space of {}\n", f.name, body(f.sphere_body), body(f.plane_body));
  for (const PassivePath& f : model.passive_paths)
    text += fmt::format("{} {}\n", std::holds_alternative<LigamentLaw>(f.law) ? "ligament" : "path spring", f.name);
  text += "\nunsupported: ";
  if (model.unsupported.empty()) text += "nothing\n";
  for (std::size_t i = 0; i < model.unsupported.size(); ++i) {
    const UnsupportedElement& u = model.unsupported[i];
    text += fmt::format("{}{} '{}'{}\n", i == 0 ? "" : "             ", u.element, u.name,
                        u.changes_motion ? " (changes the motion)" : "");
  }
  for (const std::string& warning : model.warnings) text += fmt::format("warning: {}\n", warning);
  if (!model.credits.empty()) text += fmt::format("credits: {}\n", model.credits);
  return text;
}

Summary summary_of(const std::string& file, const Model& model) {
  Summary s;
  s["file"] = file;
  s["name"] = model.name;
  s["format"] = model.version;
  s["bodies"] = Summary::array();
  for (std::size_t i = 1; i < model.bodies.size(); ++i)
    s["bodies"].push_back(Summary::object({{"name", model.bodies[i].name}, {"mass", model.bodies[i].mass}}));
  s["coordinates"] = Summary::array();
  for (const Coordinate& c : model.coordinates) {
    s["coordinates"].push_back(Summary::object({{"name", c.name},
                                                {"unit", c.unit()},
                                                {"low", c.low},
                                                {"high", c.high},
                                                {"default", c.default_value},
                                                {"locked", c.locked}}));
  }
  s["muscles"] = Summary::array();
  for (const Muscle& muscle : model.muscles) {
    const MusculotendonParameters<double>& m = muscle.parameters.musculotendon;
    s["muscles"].push_back(Summary::object({{"name", muscle.name()},
                                            {"type", type_name(muscle.parameters)},
                                            {"max_isometric_force", m.max_isometric_force},
                                            {"optimal_fiber_length", m.optimal_fiber_length},
                                            {"tendon_slack_length", m.tendon_slack_length},
                                            {"pennation_angle_at_optimal", m.pennation_angle_at_optimal}}));
  }
  s["unsupported"] = Summary::array();
  for (const UnsupportedElement& u : model.unsupported)
    s["unsupported"].push_back(Summary::object({{"element", u.element}, {"name", u.name}}));
  s["warnings"] = model.warnings;
  return s;
}

}  // namespace

bool is_model(const std::string& file) {
  if (file.ends_with(".osim") || is_model_folder(file)) return true;
  for (const EmbeddedText& model : builtin_models()) {
    if (model.name == file) return true;
  }
  return false;
}

int inspect_model(const std::string& file, const std::string& pose, bool as_opensim, const CommonOptions& options) {
  if (is_model_folder(file)) return inspect_models(file, options);
  // Made first, so that a wrong --out is refused before anything is computed.
  std::optional<OutputFolder> folder;
  if (!pose.empty() && !options.out.empty()) folder.emplace(options.out);
  const OsimFile osim = load_model(file);
  if (!pose.empty()) {
    // Poses need geometry and inertia only: forces that are not understood do not matter here.
    const MusculoskeletalSystem system(
        osim.model(), {.paths = as_opensim ? PathSource::kAsOpenSim : PathSource::kExact, .without_unsupported = true});
    const PoseTable poses = read_poses(system.model(), pose);
    for (const std::string& warning : poses.warnings) print_line(options, "warning: " + warning);
    const std::string csv = pose_csv(system, poses);
    if (folder) {
      folder->write("poses.csv", csv);
      folder->publish();
      print_line(options, fmt::format("wrote {}", (folder->path() / "poses.csv").string()));
    } else {
      print_text(csv);
    }
    return kDone;
  }
  Model model = osim.model();
  // Notes of the model as it would be simulated: switched-off muscles, points inside their wrap objects.
  Model known = model;
  known.unsupported.clear();
  const MusculoskeletalSystem system(std::move(known));
  model.warnings.insert(model.warnings.end(), system.notes().begin(), system.notes().end());
  if (options.json) {
    print_summary(summary_of(file, model), options);
  } else {
    print_text(describe(file, model));
  }
  return kDone;
}

}  // namespace veridyn::app
