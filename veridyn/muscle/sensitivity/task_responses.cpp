#include "veridyn/muscle/sensitivity/task_responses.hpp"

#include <ctime>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/numerics/parallel.hpp"

namespace veridyn::muscle {
namespace {

/// The unknowns with the start of the segment, as the model takes them.
Eigen::VectorXd theta_of(const MuscleParametricModel& model, std::size_t segment, const Eigen::VectorXd& unknowns) {
  const std::span<const estimation::ModelParameter> initial = model.initial_conditions(segment);
  Eigen::VectorXd theta(unknowns.size() + signed_index(initial.size()));
  theta.head(unknowns.size()) = unknowns;
  for (std::size_t i = 0; i < initial.size(); ++i) theta(unknowns.size() + signed_index(i)) = initial[i].start;
  return theta;
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
    : targets_(tasks.size()), segment_(tasks.size(), 0) {
  std::vector<MotionSegment> segments;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    if (!tasks[t].usable()) continue;
    segment_[t] = segments.size();
    segments.push_back(segment_of(tasks[t]));
  }
  const MuscleModelOptions options{.accuracy = accuracy};
  const MuscleParametricModel standard(subject, std::vector<MuscleUnknown>(), segments, options);
  estimation::ModelResponse response;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    if (tasks[t].usable() &&
        standard.respond(segment_[t], theta_of(standard, segment_[t], Eigen::VectorXd()), {}, response))
      targets_[t] = response.output;
  }
  model_ = std::make_unique<MuscleParametricModel>(subject, std::move(unknowns), std::move(segments), options);
}

double TaskResponses::nrmse(std::size_t task, const Eigen::VectorXd& unknowns) const {
  const estimation::RowMatrix& target = targets_[task];
  estimation::ModelResponse response;
  if (target.size() == 0) return kNaN;
  const std::size_t segment = segment_[task];
  if (!model_->respond(segment, theta_of(*model_, segment, unknowns), {}, response)) return kNaN;
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
