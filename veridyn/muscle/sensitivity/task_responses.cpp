#include "veridyn/muscle/sensitivity/task_responses.hpp"

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/numerics/batches/block_store.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"

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

void add_bits(numerics::Fingerprint& print, const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  print.add(static_cast<std::uint64_t>(matrix.rows()));
  print.add(static_cast<std::uint64_t>(matrix.cols()));
  for (const double v : matrix.reshaped()) print.add(v);
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

std::uint64_t TaskResponses::fingerprint() const {
  numerics::Fingerprint print;
  print.add(model_->accuracy());
  for (const MuscleUnknown& u : unknowns()) {
    print.add(static_cast<std::uint64_t>(u.factor));
    for (const MuscleParameterName& p : u.parameters) {
      print.add(static_cast<std::uint64_t>(p.muscle));
      print.add(static_cast<std::uint64_t>(p.field));
    }
  }
  for (const estimation::RowMatrix& target : targets_) add_bits(print, target);
  return print.value();
}

ResponseTable respond(const TaskResponses& responses, const Eigen::MatrixXd& points, std::span<const std::size_t> tasks,
                      numerics::BlockStore& store, const std::string& batch, Progress& progress) {
  const std::size_t rows = at(points.rows());
  numerics::Fingerprint print;
  print.add(responses.fingerprint());
  add_bits(print, points);
  for (const std::size_t t : tasks) print.add(static_cast<std::uint64_t>(t));
  const auto one = [&](std::size_t item) {
    const std::size_t row = item / tasks.size(), task = item % tasks.size();
    return responses.nrmse(tasks[task], points.row(row).transpose());
  };
  const numerics::BatchValues found = store.compute(
      {.name = batch, .fingerprint = print.value(), .items = rows * tasks.size(), .value = one}, progress);
  return {
      .nrmse = Eigen::Map<const estimation::RowMatrix>(found.values.data(), points.rows(), signed_index(tasks.size())),
      .simulations = rows * tasks.size(),
      .processor_seconds = found.processor_seconds,
      .completed = found.completed};
}

}  // namespace veridyn::muscle
