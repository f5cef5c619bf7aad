#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/path/pose_text.hpp"

namespace veridyn::muscle {
namespace {

int find_coordinate(const Model& model, const std::string& name) {
  const int index = model.coordinate(name);
  if (index < 0) throw InputError("locked or unlocked", model.no_coordinate(name));
  return index;
}

/// The model as it moves: coordinates locked and unlocked by the options, disabled muscles left out.
Model prepare(Model model, const SystemOptions& options, std::vector<std::string>& notes) {
  for (const std::string& name : options.locked) model.coordinates[find_coordinate(model, name)].locked = true;
  for (const std::string& name : options.unlocked) model.coordinates[find_coordinate(model, name)].locked = false;
  std::vector<std::string> left_out;
  for (const UnsupportedElement& u : model.unsupported) {
    if (u.changes_motion) left_out.push_back(fmt::format("{} '{}'", u.element, u.name));
  }
  if (!left_out.empty() && !options.without_unsupported) {
    throw InputError(
        model.name,
        fmt::format("{} would change the motion and {} not understood; without_unsupported = true continues without",
                    fmt::join(left_out, ", "), left_out.size() == 1 ? "is" : "are"));
  }
  if (!left_out.empty()) notes.push_back(fmt::format("left out, not understood: {}", fmt::join(left_out, ", ")));
  if (options.without_contact && !model.body_forces.contacts.empty()) {
    notes.push_back(fmt::format("left out: {} contacts of the model", model.body_forces.contacts.size()));
    model.body_forces.contacts.clear();
  }
  for (const Muscle& muscle : model.muscles) {
    if (!muscle.enabled) notes.push_back(fmt::format("muscle '{}' is switched off in the file", muscle.name()));
  }
  std::erase_if(model.muscles, [](const Muscle& muscle) { return !muscle.enabled; });
  return model;
}

/// What the default pose shows of points inside wrap objects, for the notes.
void note_points_inside(const Model& model, const Mechanism& mechanism, const MusclePaths& paths,
                        std::vector<std::string>& notes) {
  Kinematics<double> kinematics(mechanism);
  const Eigen::VectorXd q = model.default_pose();
  update_positions(mechanism, q.data(), kinematics);
  for (const MusclePaths::PointInside& found : paths.points_inside(kinematics, q.data()))
    notes.push_back(fmt::format("at the default pose ({}) muscle {}: point {} lies {:.2g} mm inside its wrap object {}",
                                pose_text(model, paths, found.muscle, q), model.muscles[found.muscle].name(),
                                found.point, found.depth * 1e3, found.object));
}

std::string fit_note(const Model& model, const FittedPaths& fit) {
  std::size_t length = 0, arm = 0, fitted = 0, given = 0;
  std::vector<std::string> misfits;
  for (std::size_t m = 0; m < fit.errors().size(); ++m) {
    const PathFitError& e = fit.errors()[m];
    if (e.given) {
      ++given;
      continue;
    }
    if (!e.fitted) {
      if (e.length > 0.0) misfits.push_back(fmt::format("'{}'", model.muscles[m].name()));
      continue;
    }
    if (fitted++ == 0) length = arm = m;
    if (e.length > fit.errors()[length].length) length = m;
    if (e.moment_arm > fit.errors()[arm].moment_arm) arm = m;
  }
  if (fit.errors().empty()) return "fitted paths: the model has no muscles";
  std::string note =
      fmt::format("fitted paths: {} of {} muscles, the others exact", fitted, fit.errors().size() - given);
  if (!misfits.empty()) note += fmt::format(" ({} because no polynomial is good enough)", fmt::join(misfits, ", "));
  if (fitted > 0)
    note += fmt::format("; largest error of a length {:.1e} m ('{}'), of a moment arm {:.1e} m ('{}')",
                        fit.errors()[length].length, model.muscles[length].name(), fit.errors()[arm].moment_arm,
                        model.muscles[arm].name());
  return note;
}

/// Muscles whose lengths the model gives as functions of coordinates, for the notes.
void note_functions(const Model& model, std::vector<std::string>& notes) {
  const auto given = std::count_if(model.muscles.begin(), model.muscles.end(),
                                   [](const Muscle& muscle) { return muscle.function.has_value(); });
  if (given > 0)
    notes.push_back(fmt::format("lengths of {} of {} muscles are the model's own functions of coordinates", given,
                                model.muscles.size()));
}

Model with_changes(Model model, const SystemChanges& changes) {
  for (const HeldLoad& load : changes.loads) add_load(model, load.body, load.mass, load.location);
  for (const std::string& name : changes.locked) model.coordinates[find_coordinate(model, name)].locked = true;
  if (changes.muscles.empty()) return model;
  if (changes.muscles.size() != model.muscles.size())
    throw InputError(model.name, fmt::format("has {} muscles; {} are to take their place", model.muscles.size(),
                                             changes.muscles.size()));
  for (std::size_t m = 0; m < model.muscles.size(); ++m) {
    if (changes.muscles[m].name != model.muscles[m].name())
      throw InputError(model.name, fmt::format("'{}' is to take the place of muscle '{}'", changes.muscles[m].name,
                                               model.muscles[m].name()));
    model.muscles[m].parameters = changes.muscles[m];
  }
  return model;
}

}  // namespace

MusculoskeletalSystem::MusculoskeletalSystem(Model model, const SystemOptions& options)
    : model_(prepare(std::move(model), options, notes_)),
      mechanism_(model_),
      reduction_(model_),
      loops_(model_, mechanism_),
      paths_(model_, mechanism_, options.paths == PathSource::kAsOpenSim ? WrapMode::kAsOpenSim : WrapMode::kTaut),
      source_(options.paths),
      passive_(model_, mechanism_),
      muscles_(muscle_parameters(model_)) {
  note_functions(model_, notes_);
  note_points_inside(model_, mechanism_, paths_, notes_);
  if (source_ == PathSource::kFitted) {
    PathFitOptions fit_options;
    fit_options.mixed = true;
    fit_ = std::make_shared<const FittedPaths>(model_, mechanism_, paths_, fit_options);
    notes_.push_back(fit_note(model_, *fit_));
  }
  lay_out_states();
}

MusculoskeletalSystem::MusculoskeletalSystem(const MusculoskeletalSystem& other, std::span<const HeldLoad> loads)
    : MusculoskeletalSystem(other, SystemChanges{.loads = {loads.begin(), loads.end()}}) {}

MusculoskeletalSystem::MusculoskeletalSystem(const MusculoskeletalSystem& other, const SystemChanges& changes)
    : notes_(other.notes_),
      model_(with_changes(other.model_, changes)),
      mechanism_(model_),
      reduction_(model_),
      loops_(model_, mechanism_),
      paths_(other.paths_),
      fit_(other.fit_),
      source_(other.source_),
      passive_(other.passive_),
      muscles_(muscle_parameters(model_)) {
  lay_out_states();
}

void MusculoskeletalSystem::refuse_loops(std::string_view method) const {
  if (loops_.empty()) return;
  throw InputError(model_.name,
                   fmt::format("{} does not know closed loops, and {} closes one; forward simulation, inverse "
                               "dynamics, static optimization and computed muscle control do",
                               method, loops_.constraints().front().text));
}

void MusculoskeletalSystem::lay_out_states() {
  layout_.free = reduction_.free().size();
  scales_.assign(layout_.free, 0.1);
  scales_.insert(scales_.end(), layout_.free, 1.0);
  layout_.size = scales_.size();
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    layout_.activation.push_back(muscles_.has_activation_state(m) ? static_cast<int>(layout_.size++) : -1);
    if (layout_.activation.back() >= 0) scales_.push_back(0.1);
  }
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    layout_.fiber_length.push_back(muscles_.has_fiber_state(m) ? static_cast<int>(layout_.size++) : -1);
    if (layout_.fiber_length.back() >= 0)
      scales_.push_back(0.1 * muscles_.settings(m).musculotendon.optimal_fiber_length);
  }
}

std::string MusculoskeletalSystem::state_name(std::size_t index) const {
  if (index < 2 * layout_.free) {
    const auto c = static_cast<std::size_t>(reduction_.free()[index % layout_.free]);
    return fmt::format("{} of coordinate '{}'", index < layout_.free ? "value" : "speed", model_.coordinates[c].name);
  }
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    if (layout_.activation[m] == static_cast<int>(index))
      return fmt::format("activation of muscle '{}'", model_.muscles[m].name());
    if (layout_.fiber_length[m] == static_cast<int>(index))
      return fmt::format("fibre length of muscle '{}'", model_.muscles[m].name());
  }
  return fmt::format("state {}", index);
}

}  // namespace veridyn::muscle
