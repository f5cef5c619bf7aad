#include "veridyn/muscle/muscle_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/muscle/study/muscle_study_parts.hpp"

namespace veridyn::muscle {
namespace {

/// The motion of `file`.
internal::ReadFromFiles<Motion> read_motion_file(const MotionTable& keys, const MuscleStudy& study) {
  internal::ReadFromFiles<Motion> read{.value = {}, .inputs = {*keys.file}};
  read.value = make_motion(read_signals(*keys.file), study.system->model(),
                           {.low_pass_Hz = keys.low_pass_Hz.value_or(MotionOptions{}.low_pass_Hz)});
  for (const std::string& name : read.value.beyond_range)
    read.warnings.push_back(fmt::format("the desired '{}' leaves its range", name));
  for (const int c : study.system->reduction().driven()) {
    if (study.method == MuscleMethod::kComputedMuscleControl && read.value.coordinate[c])
      read.warnings.push_back(fmt::format("'{}' is locked: it is held where the motion has it at the beginning",
                                          study.system->model().coordinates[c].name));
  }
  return read;
}

struct Times {
  double begin = 0.0, end = 1.0;  ///< [s]
};

/// Beginning and duration; those of a motion's file, where there is one, unless the study says otherwise.
Times read_times(const StudyTable& motion, const MotionTable& keys, const Motion* file) {
  Times times;
  times.begin = keys.begin.value_or(file != nullptr ? file->begin : 0.0);
  times.end = times.begin + keys.duration.value_or(file != nullptr ? file->end - times.begin : 1.0);
  if (file != nullptr && !(times.end > times.begin))
    motion.fail("begin", fmt::format("{:g} s is at or after the end of the motion, {:g} s", times.begin, file->end));
  const double slack = 1e-9 * (1.0 + std::abs(times.end));
  if (file != nullptr && (times.begin < file->begin - slack || times.end > file->end + slack)) {
    motion.fail(motion.has("duration") ? "duration" : "begin",
                fmt::format("needs {:g} .. {:g} s, the file has {:g} .. {:g} s", times.begin, times.end, file->begin,
                            file->end));
  }
  if (times.end - times.begin > 3600.0)
    motion.fail("duration", fmt::format("{:g} s is more than an hour", times.end - times.begin));
  return times;
}

void check_rate(const StudyTable& motion, const MuscleStudy& study) {
  if (!(study.rate_Hz * (study.end - study.begin) <= 1e7))
    motion.fail("rate", fmt::format("{:g} Hz makes more than 10 million rows", study.rate_Hz));
}

ControlOptions control_of(const StudyTable& table, ControlOptions o, const MuscleStudy& study) {
  if (study.method == MuscleMethod::kComputedMuscleControl && !(o.window <= study.end - study.begin)) {
    table.fail("window", fmt::format("{:g} s is longer than the motion, {:g} s", o.window, study.end - study.begin));
  }
  o.begin = study.begin;
  o.end = study.end;
  o.reserve_forces = study.reserves;
  o.accuracy = study.accuracy;
  o.rate_Hz = study.rate_Hz;
  return o;
}

StaticOptimizationOptions static_of(StaticOptimizationOptions o, const MuscleStudy& study) {
  if (std::any_of(study.reserves.begin(), study.reserves.end(), [](double r) { return r > 0.0; }))
    o.reserve = study.reserves;
  return o;
}

/// Keys of other methods: files and ramps were meant to matter, so say that they do not. Tables of excitations and
/// speeds may stay while a study's method changes: they are read in any case.
void refuse_other_methods(const StudyTable& motion, MuscleMethod method) {
  const bool forward = method == MuscleMethod::kForward;
  for (const char* key : {"file", "low_pass", "ramp"}) {
    if (motion.has(key) && forward) {
      motion.fail(key, "is a desired motion, which method = \"forward\" has no use for; the other methods follow one");
    }
  }
  for (const char* key : {"start_file", "excitation_file", "interpolation"}) {
    if (motion.has(key) && !forward)
      motion.fail(key, fmt::format("has no meaning when method = \"{}\"", method_name(method)));
  }
}

std::optional<MetabolicOptions> read_metabolic(const StudyTable& motion, const MotionTable& keys,
                                               const MuscleStudy& study) {
  const StudyTable shares = motion.table_or_empty("slow_twitch");
  MetabolicOptions options;
  options.slow_twitch.assign(study.system->muscles().size(), 0.5);
  for (const std::string& key : shares.keys()) {
    const std::size_t muscle = internal::muscle_of(shares, key, key, study.system->model());
    options.slow_twitch[muscle] = veridyn::internal::number_in(shares, key, "1", from_to(0.0, 1.0));
  }
  if (!keys.metabolic) return std::nullopt;
  if (study.method == MuscleMethod::kInverseDynamics)
    motion.fail("metabolic_cost", "inverse dynamics finds no activations that could cost");
  options.model = *keys.metabolic;
  options.aerobic_factor = keys.aerobic_factor;
  return options;
}

/// A contact of the model and an external load would press on one body twice.
void check_contact(const StudyTable& subject, const MuscleStudy& study) {
  if (!study.motion.external || subject.has("without_contact") || study.method == MuscleMethod::kInverseDynamics)
    return;
  const Model& model = study.system->model();
  for (const ExternalLoad& load : study.motion.external->loads)
    for (const SphereContact& contact : model.body_forces.contacts)
      if (contact.sphere_body == load.body)
        subject.fail("without_contact",
                     fmt::format("is needed: external load '{}' and the model's contact '{}' both act on body '{}'; "
                                 "true leaves the contacts out, false keeps them",
                                 load.name, contact.name, model.bodies[load.body].name));
}

}  // namespace

bool is_muscle_study(const StudyTable& root) {
  return root.is_table("subject") && root.table("subject").is_text("model");
}

MuscleStudy read_study(const Study& source, Progress& progress) {
  const StudyTable& root = source.root();
  static_cast<void>(root.integer_or("seed", 1));  // nothing here is random, but `--seed` sets it
  const StudyTable motion = root.table("motion");
  const MotionTable keys = MotionTable::keys().read(motion);
  const MuscleMethod method = keys.method;
  refuse_other_methods(motion, method);
  MuscleStudy study{internal::read_subject(root, progress)};
  study.method = method;
  study.motion.coordinate.resize(study.system->model().coordinates.size());
  const bool file = method != MuscleMethod::kForward && keys.file;
  if (file) study.motion = internal::remembered(read_motion_file(keys, study), study);
  const Times times = read_times(motion, keys, file ? &study.motion : nullptr);
  study.begin = times.begin;
  study.end = times.end;
  study.rate_Hz = keys.rate_Hz;
  check_rate(motion, study);
  study.accuracy = keys.accuracy;
  study.reserves = internal::read_reserves(motion, keys.reserve_force, study.system->model());
  study.start = internal::read_start(motion, study);
  study.controls = internal::remembered(internal::read_excitations(motion, keys, study), study);
  if (method == MuscleMethod::kForward) {
    study.start = internal::remembered(internal::read_start_file(motion, keys, study), study);
  } else {
    internal::DesiredMotion desired = internal::read_desired_motion(motion, study);
    study.motion = std::move(desired.motion);
    study.desired_coordinates = std::move(desired.coordinates);
  }
  study.reactions = keys.reactions;
  study.metabolic = read_metabolic(motion, keys, study);
  study.induced_accelerations = keys.induced_accelerations;
  if (study.induced_accelerations && study.method == MuscleMethod::kInverseDynamics)
    motion.fail("induced_accelerations", "inverse dynamics finds no forces of muscles that could contribute");
  study.motion.external = internal::remembered(internal::read_external_loads(motion, keys, study), study);
  study.controls.external = study.motion.external;
  check_contact(root.table("subject"), study);
  study.control = control_of(motion.table_or_empty("control"), keys.control, study);
  study.static_optimization = static_of(keys.static_optimization, study);
  // Tables of `read_task_study`: one study may say what is simulated and what is estimated.
  const std::vector<std::string> tables = root.keys();
  for (const char* key : {"tasks", "task", "parameter", "output", "person", "identify", "sensitivity"})
    if (std::find(tables.begin(), tables.end(), key) != tables.end()) root.accept(key);
  root.finish();
  return study;
}

}  // namespace veridyn::muscle
