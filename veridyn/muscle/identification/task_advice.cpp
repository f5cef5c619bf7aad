#include "veridyn/muscle/identification/task_advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/output_error/correlated_noise_model.hpp"
#include "veridyn/estimation/output_error/information.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/muscle/identification/task_warnings.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::muscle {
namespace {

using estimation::OutputErrorOptions;
using estimation::RowMatrix;

/// View of an estimate whose intervals are predicted.
class Forecast {
 public:
  Forecast(const MuscleParametricModel& model, const TaskEstimate& estimate, bool free_starts)
      : model_(model), estimate_(estimate) {
    for (Eigen::Index i = 0; i < signed_index(model.parameters().size()); ++i)
      if (!model.parameters()[i].fixed) free_.push_back(i);
    P_ = estimate.best.covariance_white(free_, free_);
    // Where the noise is estimated, intervals are widened by the freedom that the fit took: so is the noise to come.
    const auto values = static_cast<double>(estimate.best.values);
    const double unknowns = static_cast<double>(free_.size() + estimate.best.segment_parameters.size());
    const bool known = model.output_noise().size() > 0;
    options_.noise_start = estimate.best.noise_covariance.diagonal().cwiseSqrt() *
                           (known ? 1.0 : std::sqrt(values / std::max(1.0, values - unknowns)));
    options_.search_start = estimate.best.theta;
    options_.free_initial_conditions = free_starts;
    options_.threads = 1;
  }

  [[nodiscard]] bool possible() const { return !free_.empty() && P_.allFinite(); }

  /// The variances with the candidate's information; none where it cannot be simulated with the estimate.
  [[nodiscard]] std::optional<Eigen::VectorXd> after(const MuscleParametricModel& candidate) const {
    const std::optional<RowMatrix> root = information_of(candidate);
    if (!root) return std::nullopt;
    return Eigen::VectorXd(estimation::covariance_after(P_, *root).diagonal());
  }

  [[nodiscard]] Eigen::VectorXd now() const { return P_.diagonal(); }

  /// Which parameters are identified with these variances.
  [[nodiscard]] std::vector<bool> identified(const Eigen::VectorXd& variance) const {
    std::vector<bool> is;
    for (Eigen::Index k = 0; k < variance.size(); ++k) {
      const double prior = model_.parameters()[free_[k]].prior_sigma;
      is.push_back(variance(k) <= (1.0 - kIdentifiedShare) * prior * prior);
    }
    return is;
  }

  [[nodiscard]] const std::string& name(std::size_t k) const { return estimate_.best.parameters[free_[k]].name; }

  /// Of the parameters that count. Intervals shrink as the inverse information does.
  [[nodiscard]] WidestInterval widest(const Eigen::VectorXd& then, const std::vector<bool>& counts) const {
    WidestInterval widest;
    for (Eigen::Index k = 0; k < P_.rows(); ++k) {
      const std::size_t i = at(free_[k]);
      const estimation::Parameter& p = estimate_.best.parameters[i];
      if (p.status == estimation::ParameterStatus::kAtBound || !counts[k]) continue;
      const double half = 0.5 * (p.high95 - p.low95) * std::sqrt(std::max(0.0, then(k)) / P_(k, k)) *
                          std::sqrt(estimate_.chi_square > 1.0 ? estimate_.chi_square : 1.0);
      const estimation::ModelParameter& own = model_.parameters()[i];
      const bool may_be_zero = own.low <= 0.0 && own.high >= 0.0;
      const double share = half / (may_be_zero ? 0.5 * (own.high - own.low) : std::abs(own.start));
      if (share > widest.share) widest = {p.name, share};
    }
    return widest;
  }

 private:
  /// Of a recording with the noise of those that the estimate is from.
  [[nodiscard]] std::optional<RowMatrix> information_of(const MuscleParametricModel& candidate) const {
    if (estimate_.noise_correlation.size() == 0) return estimation::information_root(candidate, options_);
    std::vector<RowMatrix> complete;
    for (std::size_t s = 0; s < candidate.segments(); ++s)
      complete.emplace_back(RowMatrix::Zero(candidate.samples(s), candidate.outputs().size()));
    return estimation::information_root(
        estimation::CorrelatedNoiseModel(candidate, complete, estimate_.noise_correlation), options_);
  }

  const MuscleParametricModel& model_;
  const TaskEstimate& estimate_;
  std::vector<Eigen::Index> free_;
  Eigen::MatrixXd P_;
  OutputErrorOptions options_;
};

Eigen::VectorXd standard_values(const MuscleParametricModel& model) {
  Eigen::VectorXd theta(model.parameters().size());
  for (Eigen::Index i = 0; i < theta.size(); ++i) theta(i) = model.parameters()[i].start;
  return theta;
}

}  // namespace

std::string TaskAdvice::text() const {
  if (tasks.empty()) return withheld;
  std::string text = fmt::format("the widest interval, {}'s, would go from +-{:.2g} to {:.2g} %", now.parameter,
                                 100.0 * now.share, 100.0 * tasks.front().then.share);
  if (of_prior)
    text += " (all are nearly the priors', so that this is a forecast of the prior)";
  else if (!left_to_prior.empty())
    text += fmt::format(" (of the parameters that one task more can identify: not {})", fmt::join(left_to_prior, ", "));
  return text;
}

std::vector<PreparedTask> candidate_tasks(const MusculoskeletalSystem& subject, const ElbowTaskOptions& options,
                                          std::span<const int> used, std::vector<std::string>& left_out,
                                          Progress& progress) {
  const Model& model = subject.model();
  std::vector<Task> tasks;
  int beyond = 0;
  for (int n = 1; n <= kElbowTasks; ++n) {
    if (std::find(used.begin(), used.end(), n) != used.end()) continue;
    if (obstacle(model, options, n).empty())
      tasks.push_back(make_elbow_task(model, options, n));
    else
      ++beyond;
  }
  if (beyond > 0)
    left_out.push_back(fmt::format("{} of the {} elbow tasks are outside the model's ranges", beyond, kElbowTasks));
  std::vector<PreparedTask> candidates;
  for (PreparedTask& task : prepare_tasks(subject, std::move(tasks), progress)) {
    if (!task.usable()) {
      left_out.push_back(fmt::format("{}: {}", task.task.name, task.trouble));
    } else if (!(task.reserve_share <= kMostReserveShare)) {
      left_out.push_back(fmt::format("{}: reserves add up to {:.2g} % of the muscles' moment", task.task.name,
                                     100.0 * task.reserve_share));
    } else {
      candidates.push_back(std::move(task));
    }
  }
  return candidates;
}

TaskAdvice advise_task(const MusculoskeletalSystem& subject, const MuscleParametricModel& model,
                       const MuscleModelOptions& options, const TaskEstimate& estimate,
                       std::span<const PreparedTask> candidates, Progress& progress) {
  TaskAdvice advice;
  const Forecast forecast(model, estimate, options.estimate_start);
  if (!forecast.possible()) {
    advice.withheld = "the estimate has parameters without an interval";
    return advice;
  }
  const std::vector<MuscleUnknown> unknowns(model.unknowns().begin(), model.unknowns().end());
  const Eigen::VectorXd standard = standard_values(model);
  std::vector<std::optional<Eigen::VectorXd>> then(candidates.size());
  std::vector<std::string> why(candidates.size());
  const auto one = [&](std::size_t c) {
    const MuscleParametricModel alone(subject, unknowns, {segment_of(candidates[c])}, options);
    for (const Eigen::VectorXd& theta : {standard, estimate.best.theta}) {
      const std::vector<std::string> warnings = task_warnings(alone, theta);
      if (!warnings.empty()) why[c] = warnings.front();
    }
    if (why[c].empty()) then[c] = forecast.after(alone);
    if (why[c].empty() && !then[c]) why[c] = fmt::format("{}: the simulation cannot finish", candidates[c].task.name);
  };
  const auto proceed = [&](std::size_t done) {
    return progress.update(static_cast<double>(done) / static_cast<double>(candidates.size()));
  };
  if (!numerics::parallel_for(candidates.size(), progress.threads(), one, proceed)) return {};
  std::vector<bool> counts = forecast.identified(forecast.now());
  for (const auto& variance : then) {
    if (!variance) continue;
    const std::vector<bool> with_it = forecast.identified(*variance);
    std::transform(counts.begin(), counts.end(), with_it.begin(), counts.begin(), std::logical_or<>());
  }
  for (std::size_t k = 0; k < counts.size(); ++k)
    if (!counts[k]) advice.left_to_prior.push_back(forecast.name(k));
  advice.of_prior = advice.left_to_prior.size() == counts.size();
  if (advice.of_prior) counts.assign(counts.size(), true);
  advice.now = forecast.widest(forecast.now(), counts);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (then[c])
      advice.tasks.push_back({candidates[c].task.number, candidates[c].task.name, forecast.widest(*then[c], counts)});
    else
      advice.left_out.push_back(why[c]);
  }
  std::stable_sort(advice.tasks.begin(), advice.tasks.end(),
                   [](const AdvisedTask& a, const AdvisedTask& b) { return a.then.share < b.then.share; });
  if (advice.tasks.empty()) advice.withheld = "no further task can be advised";
  return advice;
}

}  // namespace veridyn::muscle
