#include "veridyn/muscle/study/task_recordings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle {
namespace {

using estimation::RowMatrix;

double noise_of(const TaskStudy& study, const MuscleOutput& output) {
  return output.kind == MuscleOutputKind::kValue ? study.person->noise : output.noise_sd;
}

/// What each task's recording would be of a simulated person; empty where it cannot perform it.
std::vector<RowMatrix> simulate_person(const TaskStudy& study, const std::vector<PreparedTask>& tasks,
                                       TaskRecordings& out, const Progress& progress) {
  const Eigen::VectorXd hidden = internal::hidden_values(study);
  for (std::size_t i = 0; i < study.unknowns.size(); ++i) out.truth[study.unknowns[i].name] = hidden(i);
  std::vector<std::shared_ptr<const MusculoskeletalSystem>> systems;
  std::vector<MotionSegment> segments = segments_of(tasks);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    systems.push_back(internal::person_system(study, tasks[s].task));
    segments[s].system = systems.back().get();
  }
  const MuscleParametricModel person(*study.subject.system, study.unknowns, std::move(segments),
                                     {.accuracy = study.accuracy, .outputs = study.outputs});
  std::vector<RowMatrix> measured = simulate_tasks(person, hidden, progress.threads());
  for (std::size_t s = 0; s < measured.size(); ++s) {
    if (measured[s].size() == 0) continue;
    numerics::RandomStream random(study.seed, "noise of " + tasks[s].task.name);
    std::vector<internal::RecordingNoise> noise;
    for (const MuscleOutput& output : study.outputs)
      noise.emplace_back(output.kind == MuscleOutputKind::kValue ? study.person->noise_correlation_s : 0.0);
    for (Eigen::Index k = 0; k < measured[s].rows(); ++k) {
      for (std::size_t j = 0; j < study.outputs.size(); ++j)
        measured[s](k, signed_index(j)) += noise_of(study, study.outputs[j]) * noise[j].next(tasks[s].time[k], random);
    }
  }
  return measured;
}

TaskRecordings recorded_forward_tasks(const TaskStudy& study, Progress& progress) {
  TaskRecordings out;
  progress.stage(fmt::format("controls of {} tasks", study.tasks.size()));
  std::vector<PreparedTask> tasks;
  for (PreparedTask& task : prepare_tasks(*study.subject.system, study.tasks, progress)) {
    if (task.usable())
      tasks.push_back(std::move(task));
    else
      out.unused.push_back(fmt::format("{}: {}", task.task.name, task.trouble));
  }
  if (progress.interrupted()) return out;
  std::vector<RowMatrix> measured;
  if (study.person) {
    measured = simulate_person(study, tasks, out, progress);
  } else {
    for (const PreparedTask& task : tasks) measured.push_back(task.task.measured->values);
  }
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (measured[i].size() == 0) {
      out.unused.push_back(fmt::format("{}: the simulated person cannot perform it", tasks[i].task.name));
      continue;
    }
    out.tasks.push_back({.name = tasks[i].task.name,
                         .hold_out = tasks[i].task.hold_out,
                         .reserve_share = tasks[i].reserve_share,
                         .time = tasks[i].time,
                         .measured = std::move(measured[i]),
                         .forward = segment_of(tasks[i]),
                         .system = tasks[i].system});
  }
  return out;
}

}  // namespace

Eigen::VectorXd start_values(const std::vector<MuscleUnknown>& unknowns) {
  Eigen::VectorXd theta(unknowns.size());
  for (std::size_t i = 0; i < unknowns.size(); ++i) theta(i) = unknowns[i].start;
  return theta;
}

TaskRecordings task_recordings(const TaskStudy& study, Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  TaskRecordings out =
      study.emg ? internal::emg_task_recordings(study, progress) : recorded_forward_tasks(study, progress);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return out;
}

namespace internal {

double RecordingNoise::next(double time, numerics::RandomStream& random) {
  const double kept = correlation_s_ > 0.0 && !first_ ? std::exp(-(time - time_) / correlation_s_) : 0.0;
  value_ = kept * value_ + std::sqrt(1.0 - kept * kept) * random.normal();
  time_ = time;
  first_ = false;
  return value_;
}

Eigen::VectorXd hidden_values(const TaskStudy& study) {
  Eigen::VectorXd theta = start_values(study.unknowns);
  for (std::size_t i = 0; i < study.unknowns.size(); ++i) {
    const MuscleUnknown& u = study.unknowns[i];
    numerics::RandomStream random(study.seed, "hidden " + u.name);
    const double spread = random.uniform(-1.0, 1.0);
    // A share of a delay, which may be zero, is none.
    const double drawn = u.is_delay() ? u.start + 0.5 * spread * (spread < 0.0 ? u.start - u.low : u.high - u.start)
                                      : u.start * (1.0 + study.person->spread * spread);
    if (u.fixed) continue;
    const auto set = study.person->values.find(u.name);
    theta(i) = set != study.person->values.end() ? set->second : std::clamp(drawn, u.low, u.high);
  }
  return theta;
}

std::shared_ptr<const MusculoskeletalSystem> person_system(const TaskStudy& study, const Task& task) {
  SystemChanges changes{.loads = task.loads};
  for (HeldLoad& load : changes.loads) load.mass *= study.person->load_factor;
  const Model& model = study.subject.system->model();
  for (const HeldCoordinate& held : task.held) changes.locked.push_back(model.coordinates[held.coordinate].name);
  changes.muscles = muscle_parameters(model);
  for (MuscleParameters& muscle : changes.muscles) {
    if (!study.person->millard) continue;
    muscle.curves = MillardCurves{};
    muscle.fiber_damping = 0.1;
  }
  return std::make_shared<const MusculoskeletalSystem>(study.person->body ? *study.person->body : *study.subject.system,
                                                       changes);
}

}  // namespace internal

}  // namespace veridyn::muscle
