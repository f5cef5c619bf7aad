// The subject of a muscle study: which model, changed in what.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "veridyn/core/nearest.hpp"
#include "veridyn/muscle/identification/normalised_fiber_lengths.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/study/muscle_study_parts.hpp"

namespace veridyn::muscle::internal {
namespace {

std::string known_parameters() {
  std::string text;
  for (const MusculotendonField& p : kMusculotendonFields)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", p.name);
  return text;
}

void set_parameter(const StudyTable& table, const std::string& key, const std::string& muscle,
                   const std::string& parameter, Model& model, std::vector<ParameterChange>& changes) {
  Muscle& m = model.muscles[muscle_of(table, key, muscle, model)];
  const auto found = std::find_if(kMusculotendonFields.begin(), kMusculotendonFields.end(),
                                  [&](const MusculotendonField& p) { return p.name == parameter; });
  if (found == kMusculotendonFields.end()) {
    std::vector<std::string> names;
    for (const MusculotendonField& p : kMusculotendonFields) names.emplace_back(p.name);
    table.fail(key, fmt::format("a muscle has no parameter '{}'{}", parameter, suggestion(parameter, names)));
  }
  double& value = field_of(m.parameters.musculotendon, static_cast<std::size_t>(found - kMusculotendonFields.begin()));
  const double before = value;
  if (std::string_view(found->unit) == "rad") {
    value = table.number(key, "rad");
    if (!(value >= 0.0 && value < 1.5)) table.fail(key, fmt::format("{:g} rad must be from 0 to 1.5 rad", value));
  } else {
    value = table.positive(key, found->unit);
  }
  changes.push_back({muscle, parameter, before, value});
}

void read_parameters(const StudyTable& table, Model& model, std::vector<ParameterChange>& changes) {
  for (const std::string& key : table.keys()) {
    if (table.is_table(key)) {  // BIClong.optimal_fiber_length without quotes
      const StudyTable muscle = table.table(key);
      for (const std::string& parameter : muscle.keys())
        set_parameter(muscle, parameter, key, parameter, model, changes);
      continue;
    }
    const std::size_t dot = key.rfind('.');
    if (dot == std::string::npos) {
      table.fail(key, fmt::format("is not MUSCLE.PARAMETER with a parameter of {}", known_parameters()));
    }
    set_parameter(table, key, key.substr(0, dot), key.substr(dot + 1), model, changes);
  }
}

std::string parameters_sentence() {
  std::string text;
  for (const MusculotendonField& p : kMusculotendonFields)
    text += fmt::format("{}`{}`{}", text.empty() ? "" : ", ", p.name,
                        std::string_view(p.unit) == "1" ? "" : fmt::format(" [{}]", p.unit));
  return "a table, `\"MUSCLE.PARAMETER\" = value`, set after `fiber_lengths_from`: " + text;
}

/// A file, or a built-in model by its name.
OsimFile read_model(const StudyTable& subject, const std::string& key, std::vector<std::filesystem::path>& inputs) {
  const std::string name = subject.text(key);
  if (name.find('.') != std::string::npos || name.find('/') != std::string::npos) {
    inputs.push_back(subject.file(key));
    return OsimFile::load(inputs.back());
  }
  std::vector<std::string> names;
  for (const EmbeddedText& model : builtin_models()) names.emplace_back(model.name);
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    subject.fail(key,
                 fmt::format("= '{}' is no built-in model{}; a file ends in .osim", name, suggestion(name, names)));
  }
  return load_model(name);
}

/// L0 and LS of a model's muscles from those of a reference with the same names.
struct MatchedLengths {
  Model model;
  std::vector<ParameterChange> changes;
};

/// What has no match keeps its own lengths and is named.
ReadFromFiles<MatchedLengths> matched_to_reference(const StudyTable& subject, const Model& model, Progress& progress) {
  constexpr double kPoorMatch = 0.05;
  const std::string key = "fiber_lengths_from";
  ReadFromFiles<MatchedLengths> read{.value = {.model = model, .changes = {}}};
  const OsimFile file = read_model(subject, key, read.inputs);
  progress.stage("matching normalised fibre lengths to the reference");
  const SystemOptions paths_only{.without_unsupported = true};
  const MusculoskeletalSystem reference(file.model(), paths_only), own(model, paths_only);
  for (const MatchedFiber& fiber : match_fiber_lengths(reference, own)) {
    const std::string& name = own.model().muscles[fiber.muscle].name();
    if (!fiber.usable()) {
      read.warnings.push_back(fmt::format("{} keeps its own fibre and tendon lengths: {}", name, fiber.obstacle));
      continue;
    }
    if (fiber.error > kPoorMatch)
      read.warnings.push_back(
          fmt::format("{}: normalised fibre lengths still differ from the reference's by {:.2g} (root mean square): "
                      "another path, or other curves",
                      name, fiber.error));
    MusculotendonParameters<double>& lengths = read.value.model.muscles[model.muscle(name)].parameters.musculotendon;
    const auto set = [&](const char* parameter, double& target, double value) {
      read.value.changes.push_back({name, parameter, target, value});
      target = value;
    };
    set("optimal_fiber_length", lengths.optimal_fiber_length, fiber.optimal_fiber_length);
    set("tendon_slack_length", lengths.tendon_slack_length, fiber.tendon_slack_length);
  }
  if (read.value.changes.empty())
    subject.fail(key, fmt::format("has no muscle that matches one of '{}'", subject.text("model")));
  return read;
}

}  // namespace

const KeyTable<HeldLoad>& load_keys() {
  static const auto table =
      KeyTable<HeldLoad>("subject.load", "A point mass that a body carries.")
          .repeated()
          .text("body", &HeldLoad::body, "that carries it")
          .required()
          .number("mass", &HeldLoad::mass, "kg", kPositive, "of the load")
          .required()
          .numbers("location", &HeldLoad::location, "m", kAnyNumber, "x, y, z in the body's frame");
  return table;
}

const KeyTable<SystemOptions>& subject_keys() {
  using O = SystemOptions;
  static const auto table =
      KeyTable<O>("subject", "The model, and what of it is changed.")
          .elsewhere({"model", "", "", "", "a file `.osim`, or the name of a built-in model: `arm`, `legs`"})
          .required()
          .choice("paths", &O::paths,
                  {{"exact", PathSource::kExact}, {"fitted", PathSource::kFitted}, {"opensim", PathSource::kAsOpenSim}},
                  "where lengths of muscle paths come from")
          .texts("locked", &O::locked, "coordinates held where they start although the model frees them")
          .texts("unlocked", &O::unlocked, "coordinates that move although the model locks them")
          .flag("without_contact", &O::without_contact,
                "leave the model's contacts out; must be said where an external load acts on a body with contact")
          .flag("without_unsupported", &O::without_unsupported,
                "go on without forces and constraints that are not understood")
          .elsewhere({"fiber_lengths_from", "", "", "none",
                      "a reference model (file or built-in): L0 and LS of each muscle become those with which its "
                      "normalised fibre lengths and tendon strains at the same joint angles are the reference's "
                      "(Modenese et al. 2016): the first guess for a model of which only the bones were scaled. "
                      "Muscles are matched by name; what has no match, or a poor one, is named",
                      true})
          .elsewhere({"parameters", "", "", "the model's", parameters_sentence(), true});
  return table;
}

HeldLoad read_load(const StudyTable& table, const Model& model) {
  HeldLoad load = load_keys().read(table);
  const int body = model.body(load.body);
  if (body <= 0) {
    std::vector<std::string> names;
    for (std::size_t i = 1; i < model.bodies.size(); ++i) names.push_back(model.bodies[i].name);
    table.fail("body", fmt::format("= '{}' is no body of model '{}' that could carry a load{}", load.body, model.name,
                                   suggestion(load.body, names)));
  }
  return load;
}

std::size_t muscle_of(const StudyTable& table, const std::string& key, const std::string& name, const Model& model) {
  const int index = model.muscle(name);
  if (index < 0) table.fail(key, model.no_muscle(name));
  return static_cast<std::size_t>(index);
}

std::size_t coordinate_of(const StudyTable& table, const std::string& key, const std::string& name,
                          const Model& model) {
  const int index = model.coordinate(name);
  if (index < 0) table.fail(key, model.no_coordinate(name));
  return static_cast<std::size_t>(index);
}

double coordinate_value(const StudyTable& table, const std::string& key, const Coordinate& c) {
  const double value = table.number(key, c.unit());
  if (!c.in_range(value)) table.fail(key, c.outside_range(value));
  return value;
}

void check_not_coupled(const StudyTable& table, const std::string& key, std::size_t c, const MuscleSubject& subject) {
  if (subject.system->reduction().role(static_cast<int>(c)) == CoordinateRole::kCoupled) {
    table.fail(key, fmt::format("'{}' follows another coordinate through a coupler; set that one",
                                subject.system->model().coordinates[c].name));
  }
}

MuscleSubject read_subject(const StudyTable& root, Progress& progress) {
  const StudyTable table = root.table("subject");
  const SystemOptions options = subject_keys().read(table);
  MuscleSubject subject;
  subject.title = root.text_or("title", "");
  subject.model_name = table.text("model");
  subject.file.emplace(read_model(table, "model", subject.inputs));
  subject.written = subject.file->model();
  if (table.has("fiber_lengths_from")) {
    MatchedLengths matched = remembered(matched_to_reference(table, subject.written, progress), subject);
    subject.written = std::move(matched.model);
    subject.changes = std::move(matched.changes);
  }
  read_parameters(table.table_or_empty("parameters"), subject.written, subject.changes);
  Model model = subject.written;
  for (const StudyTable& of : table.tables("load")) {
    subject.loads.push_back(read_load(of, model));
    const HeldLoad& load = subject.loads.back();
    add_load(model, load.body, load.mass, load.location);
  }
  for (const std::string& name : options.locked) static_cast<void>(coordinate_of(table, "locked", name, model));
  for (const std::string& name : options.unlocked) static_cast<void>(coordinate_of(table, "unlocked", name, model));
  for (const std::string& name : options.unlocked) {
    if (std::find(options.locked.begin(), options.locked.end(), name) != options.locked.end())
      table.fail("unlocked", fmt::format("names '{}', which subject.locked names too", name));
  }
  if (options.paths == PathSource::kFitted) progress.stage("fitting polynomials to the muscle paths");
  subject.system = std::make_unique<MusculoskeletalSystem>(std::move(model), options);
  if (subject.system->reduction().free().empty())
    table.fail("locked", "leaves no coordinate that could move: all are locked or coupled");
  if (subject.title.empty()) subject.title = subject.system->model().name;
  return subject;
}

}  // namespace veridyn::muscle::internal
