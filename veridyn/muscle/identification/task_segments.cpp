#include "veridyn/muscle/identification/task_segments.hpp"

#include <stdexcept>

#include "veridyn/core/index.hpp"

namespace veridyn::muscle {

MotionSegment segment_of(const PreparedTask& task) {
  if (!task.usable()) throw std::invalid_argument(task.task.name + ": " + task.trouble);
  return {.start = task.start,
          .controls = task.controls,
          .time = task.time,
          .system = task.system.get(),
          .name = task.task.name};
}

std::vector<MotionSegment> segments_of(std::span<const PreparedTask> tasks) {
  std::vector<MotionSegment> segments;
  for (const PreparedTask& task : tasks) segments.push_back(segment_of(task));
  return segments;
}

std::vector<estimation::RowMatrix> simulate_tasks(const estimation::ParametricModel& model,
                                                  const Eigen::VectorXd& theta, int threads) {
  std::vector<estimation::RowMatrix> outputs(model.segments());
  estimation::for_each_segment(model, threads, [&](std::size_t s) {
    const auto initial = model.initial_conditions(s);
    Eigen::VectorXd all(theta.size() + signed_index(initial.size()));
    all.head(theta.size()) = theta;
    for (std::size_t i = 0; i < initial.size(); ++i) all(theta.size() + signed_index(i)) = initial[i].start;
    estimation::ModelResponse response;
    if (model.respond(s, all, {}, response)) outputs[s] = std::move(response.output);
  });
  return outputs;
}

}  // namespace veridyn::muscle
