#include "veridyn/muscle/study/task_part.hpp"

#include <utility>

#include "veridyn/muscle/tasks/task_error.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"

namespace veridyn::muscle {
namespace {

estimation::LoggedModel::Misfit nrmse_of(const TaskPart& part) {
  return [tasks = part.tasks](std::size_t segment, const estimation::RowMatrix& output) {
    return task_error(tasks[segment]->measured, output).nrmse;
  };
}

}  // namespace

MuscleModelOptions model_options(const TaskStudy& study) {
  return {.accuracy = study.accuracy, .estimate_start = study.estimate_start, .outputs = study.outputs};
}

TaskPart task_part(const TaskStudy& study, const TaskRecordings& all, bool hold_out) {
  TaskPart part;
  std::vector<MotionSegment> forward;
  std::vector<EmgSegment> along;
  for (const TaskRecording& task : all.tasks) {
    if (task.hold_out != hold_out) continue;
    part.tasks.push_back(&task);
    part.measured.push_back(task.measured);
    if (task.forward) forward.push_back(*task.forward);
    if (task.along) along.push_back(*task.along);
  }
  if (part.tasks.empty()) return part;
  const MusculoskeletalSystem& system = *study.subject.system;
  if (study.emg)
    part.along = std::make_unique<EmgDrivenModel>(system, study.unknowns, std::move(along), study.outputs,
                                                  study.emg->signal_of, study.accuracy, study.emg->error);
  else
    part.forward =
        std::make_unique<MuscleParametricModel>(system, study.unknowns, std::move(forward), model_options(study));
  return part;
}

std::uint64_t fingerprint_of(const TaskStudy& study, const TaskPart& part) {
  numerics::Fingerprint key;
  key.add(study.subject.title);
  for (const MuscleUnknown& u : study.unknowns) key.add(u.name);
  for (const estimation::RowMatrix& measured : part.measured) {
    key.add(static_cast<std::uint64_t>(measured.rows()));
    for (const double value : measured.reshaped()) key.add(value);
  }
  return key.value();
}

SearchedTasks::SearchedTasks(const TaskPart& trained, numerics::SharedWork& work, numerics::ValueLog* log)
    : part(&trained), shared(trained.model(), work), logged(shared, "trained", nrmse_of(trained), log) {}

}  // namespace veridyn::muscle
