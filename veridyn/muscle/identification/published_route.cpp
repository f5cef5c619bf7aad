#include "veridyn/muscle/identification/published_route.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/muscle/tasks/task_error.hpp"

namespace veridyn::muscle {
namespace {

/// Unknowns that are searched for.
std::vector<std::size_t> searched(const MuscleParametricModel& model) {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < model.unknowns().size(); ++i) {
    if (!model.unknowns()[i].fixed) list.push_back(i);
  }
  return list;
}

Eigen::VectorXd all_unknowns(const MuscleParametricModel& model, const std::vector<std::size_t>& list,
                             const Eigen::VectorXd& x) {
  Eigen::VectorXd theta(model.unknowns().size());
  for (std::size_t i = 0; i < model.unknowns().size(); ++i) theta(i) = model.unknowns()[i].start;
  for (std::size_t k = 0; k < list.size(); ++k) theta(list[k]) = x(k);
  return theta;
}

/// FNV-1a over the bits of the targets: another recording is another search.
std::uint64_t checksum_of(std::span<const estimation::RowMatrix> targets) {
  std::uint64_t sum = 0xcbf29ce484222325ULL;
  for (const estimation::RowMatrix& target : targets) {
    for (const double value : target.reshaped<Eigen::RowMajor>()) {
      const std::uint64_t bits = value != value ? 1 : std::bit_cast<std::uint64_t>(value);
      for (int byte = 0; byte < 8; ++byte) sum = (sum ^ (bits >> (8 * byte) & 0xff)) * 0x100000001b3ULL;
    }
  }
  return sum;
}

std::vector<double> errors_at(const estimation::ParametricModel& model, std::span<const estimation::RowMatrix> targets,
                              const Eigen::VectorXd& theta) {
  const std::vector<estimation::RowMatrix> predicted = simulate_tasks(model, theta, 1);
  std::vector<double> nrmse;
  for (std::size_t s = 0; s < targets.size(); ++s) nrmse.push_back(task_error(targets[s], predicted[s]).nrmse);
  return nrmse;
}

estimation::BlackBoxProblem problem_of(const MuscleParametricModel& model, const estimation::ParametricModel& responses,
                                       std::span<const estimation::RowMatrix> targets,
                                       const PublishedRouteOptions& options) {
  const std::vector<std::size_t> list = searched(model);
  estimation::BlackBoxProblem p{.name = "muscles by the published route"};
  p.low.resize(list.size());
  p.high.resize(list.size());
  for (std::size_t k = 0; k < list.size(); ++k) {
    const MuscleUnknown& u = model.unknowns()[list[k]];
    p.names.push_back(u.name);
    p.low(k) = u.low;
    p.high(k) = u.high;
  }
  for (std::size_t s = 0; s < model.segments(); ++s)
    p.constraint_names.push_back(fmt::format("{} NRMSE - tolerance", model.segment_name(s)));
  p.identity = {{"tolerance", fmt::format("{}", options.tolerance)},
                {"targets", fmt::format("{:016x}", checksum_of(targets))},
                {"accuracy", fmt::format("{}", model.accuracy())},
                {"swarm", fmt::format("{} particles, {} iterations, seed {}", options.swarm.particles,
                                      options.swarm.iterations, options.swarm.seed)},
                {"pattern", fmt::format("mesh {} to {}, seed {}", options.pattern.initial_mesh,
                                        options.pattern.tolerance, options.pattern.seed)}};
  p.evaluate = [&model, &responses, targets, list, tolerance = options.tolerance](const Eigen::VectorXd& x) {
    estimation::SearchValues values{.objective = 0.0,
                                    .constraints = errors_at(responses, targets, all_unknowns(model, list, x))};
    for (double& error : values.constraints) {
      values.objective += error;
      error -= tolerance;
    }
    return values;
  };
  return p;
}

estimation::ModelEvaluation noted(const estimation::SearchEvaluation& e, const MuscleParametricModel& model,
                                  double tolerance) {
  estimation::ModelEvaluation out{.theta = all_unknowns(model, searched(model), e.x), .seconds = e.seconds};
  for (const double c : e.values.constraints) {
    out.misfit.push_back(c + tolerance);
    out.failed.push_back(std::isfinite(c) ? 0 : 1);
  }
  return out;
}

}  // namespace

void PublishedRouteOptions::validate() const {
  if (!(tolerance > 0.0)) throw InputError("search.tolerance", fmt::format("is {}; must be > 0", tolerance));
  swarm.validate();
  pattern.validate();
}

std::string PublishedRouteResult::message() const {
  return fmt::format("swarm: {}; pattern search: {}", swarm.message(), pattern.message());
}

PublishedRouteResult published_route(const MuscleParametricModel& model, std::span<const estimation::RowMatrix> targets,
                                     const PublishedRouteOptions& options, Progress& progress,
                                     const estimation::ParametricModel* responses) {
  options.validate();
  if (targets.size() != model.segments())
    throw InputError("targets", fmt::format("{} for {} tasks", targets.size(), model.segments()));
  for (std::size_t s = 0; s < targets.size(); ++s) {
    if (!task_error(targets[s], targets[s]).moves)
      throw InputError(model.segment_name(s), "its target moves less than 1 deg: there is no NRMSE");
  }
  if (responses == nullptr) responses = &model;
  estimation::BatchEvaluator evaluator(problem_of(model, *responses, targets, options), options.evaluation, progress);
  PublishedRouteResult result;
  progress.stage("particle swarm until feasible");
  result.swarm = estimation::particle_swarm(evaluator, options.swarm);
  const auto stopped = [](const estimation::SearchResult& r) {
    return r.termination == estimation::SearchTermination::kInterrupted ||
           r.termination == estimation::SearchTermination::kEvaluations;
  };
  result.pattern = result.swarm;
  if (!stopped(result.swarm)) {
    progress.stage("pattern search");
    result.pattern = estimation::pattern_search(evaluator, result.swarm.x, options.pattern);
  }
  if (result.pattern.x.size() > 0) result.theta = all_unknowns(model, searched(model), result.pattern.x);
  for (const double c : result.pattern.values.constraints) result.nrmse.push_back(c + options.tolerance);
  for (const estimation::SearchEvaluation& e : evaluator.evaluations())
    result.evaluations.push_back(noted(e, model, options.tolerance));
  result.resumed = evaluator.resumed();
  result.failed = evaluator.failed();
  result.simulations = result.evaluations.size() * model.segments();
  for (const estimation::ModelEvaluation& e : result.evaluations) result.seconds += e.seconds;
  return result;
}

}  // namespace veridyn::muscle
