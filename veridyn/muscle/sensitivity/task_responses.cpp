#include "veridyn/muscle/sensitivity/task_responses.hpp"

#include <ctime>
#include <limits>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/tasks/task_error.hpp"
#include "veridyn/numerics/parallel.hpp"

namespace veridyn::muscle {
namespace {

std::vector<MotionSegment> segments_of(std::span<const PreparedTask> tasks) {
  std::vector<MotionSegment> segments;
  for (const PreparedTask& t : tasks)
    segments.push_back(
        {.start = t.start, .drive = t.drive, .time = t.time, .system = t.system.get(), .name = t.task.name});
  return segments;
}

/// Processor time of the calling thread [s].
double thread_seconds() {
  std::timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

TaskResponses::TaskResponses(const MusculoskeletalSystem& subject, std::vector<MuscleUnknown> unknowns,
                             std::span<const PreparedTask> tasks, double accuracy)
    : targets_(tasks.size()) {
  const MuscleModelOptions options{.accuracy = accuracy};
  const MuscleParametricModel standard(subject, std::vector<MuscleUnknown>(), segments_of(tasks), options);
  estimation::ModelResponse response;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    if (tasks[t].usable() && standard.respond(t, Eigen::VectorXd(), {}, response)) targets_[t] = response.output;
  }
  model_ = std::make_unique<MuscleParametricModel>(subject, std::move(unknowns), segments_of(tasks), options);
}

double TaskResponses::nrmse(std::size_t task, const Eigen::VectorXd& unknowns) const {
  const estimation::RowMatrix& target = targets_[task];
  estimation::ModelResponse response;
  if (target.size() == 0 || !model_->respond(task, unknowns, {}, response))
    return std::numeric_limits<double>::quiet_NaN();
  return task_error(target, response.output).nrmse;
}

ResponseTable respond(const TaskResponses& responses, const Eigen::MatrixXd& points, std::span<const std::size_t> tasks,
                      Progress& progress) {
  const std::size_t rows = at(points.rows()), all = rows * tasks.size();
  ResponseTable table{.nrmse = Eigen::MatrixXd(points.rows(), signed_index(tasks.size()))};
  std::vector<double> seconds(all);
  const auto one = [&](std::size_t item) {
    const double begun = thread_seconds();
    const std::size_t row = item / tasks.size(), task = item % tasks.size();
    table.nrmse(signed_index(row), signed_index(task)) =
        responses.nrmse(tasks[task], points.row(signed_index(row)).transpose());
    seconds[item] = thread_seconds() - begun;
  };
  const auto proceed = [&](std::size_t done) {
    return progress.update(static_cast<double>(done) / static_cast<double>(all));
  };
  table.completed = numerics::parallel_for(all, progress.threads(), one, proceed);
  table.simulations = all;
  for (const double s : seconds) table.processor_seconds += s;
  return table;
}

}  // namespace veridyn::muscle
