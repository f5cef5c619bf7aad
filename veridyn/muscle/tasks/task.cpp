#include "veridyn/muscle/tasks/task.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/quiet_progress.hpp"
#include "veridyn/muscle/simulation/motion_analysis.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::muscle {
namespace {

std::shared_ptr<const MusculoskeletalSystem> system_of_task(const MusculoskeletalSystem& subject, const Task& task) {
  SystemChanges changes{.loads = task.loads};
  for (const HeldCoordinate& held : task.held) {
    const Coordinate& coordinate = subject.model().coordinates[held.coordinate];
    if (!coordinate.in_range(held.value)) throw InputError(task.name, coordinate.outside_range(held.value));
    changes.locked.push_back(coordinate.name);
  }
  auto system = std::make_shared<const MusculoskeletalSystem>(subject, changes);
  if (system->reduction().free().empty()) throw InputError(task.name, "holds every coordinate that could move");
  return system;
}

/// Pose and speeds of the desired motion where the task begins.
StartState start_of(const MusculoskeletalSystem& system, const Task& task) {
  StartState start = default_start(system.model());
  start.qdot.setZero();
  for (std::size_t c = 0; c < task.desired.coordinate.size(); ++c) {
    if (!task.desired.coordinate[c]) continue;
    const auto i = signed_index(c);
    const auto desired = task.desired.coordinate[c]->evaluate(task.begin);
    start.q(i) = desired.value;
    if (system.reduction().role(static_cast<int>(c)) == CoordinateRole::kFree) start.qdot(i) = desired.slope;
  }
  for (const HeldCoordinate& held : task.held) start.q(held.coordinate) = held.value;
  return start;
}

/// The largest reserve of any free coordinate over the largest moment of its muscles.
double share_of_reserves(const MusculoskeletalSystem& system, const MuscleTrajectory& t) {
  if (t.reserve.size() == 0) return 0.0;
  SystemEvaluator<double> evaluator(system);
  double share = 0.0;
  for (const int c : system.reduction().free()) {
    double moment = 0.0;
    for (std::size_t i = 0; i < t.time.size(); ++i) {
      const auto row = signed_index(i);
      double sum = 0.0;
      evaluator.set_all(t.q.row(row).data(), t.qdot.row(row).data());
      for (std::size_t k = 0; k < system.pairs().size(); ++k) {
        const auto& pair = system.pairs()[k];
        if (pair.coordinate == c) sum -= t.tendon_force(row, pair.muscle) * evaluator.path_gradient()[k];
      }
      moment = std::max(moment, std::abs(sum));
    }
    const double reserve = t.reserve.col(c).cwiseAbs().maxCoeff();
    if (moment > 0.0) share = std::max(share, reserve / moment);
  }
  return share;
}

void add_controls(PreparedTask& prepared, const Progress& progress) {
  const Task& task = prepared.task;
  const MusculoskeletalSystem& system = *prepared.system;
  if (task.controls) {
    prepared.start = start_of(system, task);
    prepared.controls = *task.controls;
    return;
  }
  ControlOptions options = task.control;
  options.begin = task.begin;
  options.end = task.end;
  options.rate_Hz = task.rate_Hz;
  QuietProgress silent(progress);
  ControlResult found = computed_muscle_control(system, task.desired, options, silent);
  if (!found.usable()) {
    prepared.trouble = fmt::format("the standard model cannot follow it: {}", found.trajectory.message());
    return;
  }
  for (const int c : system.reduction().free())
    prepared.tracking_error = std::max(prepared.tracking_error, found.tracking_error(c));
  prepared.overloaded = found.overloaded.size();
  prepared.reserve_share = share_of_reserves(system, found.trajectory);
  prepared.start = std::move(found.start);
  prepared.controls = std::move(found.controls);
}

}  // namespace

std::vector<PreparedTask> prepare_tasks(const MusculoskeletalSystem& subject, std::vector<Task> tasks,
                                        Progress& progress) {
  std::vector<PreparedTask> prepared(tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    PreparedTask& p = prepared[i];
    p.task = std::move(tasks[i]);
    p.system = system_of_task(subject, p.task);
    p.time = p.task.measured ? p.task.measured->time : frame_times(p.task.begin, p.task.end, p.task.rate_Hz);
  }
  numerics::parallel_for(
      prepared.size(), progress.threads(), [&](std::size_t i) { add_controls(prepared[i], progress); },
      [&](std::size_t done) {
        return progress.update(static_cast<double>(done) / static_cast<double>(prepared.size()));
      });
  return prepared;
}

}  // namespace veridyn::muscle
