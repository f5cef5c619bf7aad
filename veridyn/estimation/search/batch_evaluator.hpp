#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/search/black_box_problem.hpp"
#include "veridyn/estimation/search/search_log.hpp"

namespace veridyn::estimation {

/// How evaluations are made and kept.
struct EvaluationOptions {
  std::size_t max_evaluations = std::numeric_limits<std::size_t>::max();  ///< of all searches together
  std::filesystem::path log = {};  ///< empty: in memory only. A log that is there is continued
};

/// View of a `Progress`, on the threads of which it evaluates a problem in batches, with the same bits on any number of
/// them.
///
/// No point is evaluated twice; each evaluation goes to the log. Where the log comes from an earlier run, the same
/// searches are answered from it until it ends: they then continue as if they had never been interrupted.
class BatchEvaluator {
 public:
  /// @throws InputError for a problem that is out of order, or a log of another one.
  BatchEvaluator(BlackBoxProblem problem, const EvaluationOptions& options, Progress& progress);

  /// Values at the points, in their order. False where the evaluations are used up or the progress asked to stop
  /// (`ended`): then nothing of this batch counts.
  /// @throws InputError when the log of the earlier run holds other points: of another version, say.
  [[nodiscard]] bool evaluate(std::span<const Eigen::VectorXd> points, std::vector<SearchValues>& values);
  /// kEvaluations or kInterrupted, after `evaluate` returned false.
  [[nodiscard]] SearchTermination ended() const { return ended_; }

  [[nodiscard]] const BlackBoxProblem& problem() const { return problem_; }
  /// Those that the searches of this run have come to.
  [[nodiscard]] std::span<const SearchEvaluation> evaluations() const { return log_.evaluations().first(used_); }
  [[nodiscard]] std::size_t failed() const { return failed_; }
  /// Of the evaluations were answered from an earlier run's log.
  [[nodiscard]] std::size_t resumed() const { return std::min(used_, log_.loaded()); }
  [[nodiscard]] Progress& progress() { return *progress_; }

 private:
  [[nodiscard]] bool take_from_log(std::span<const Eigen::VectorXd> points);
  [[nodiscard]] bool compute(std::span<const Eigen::VectorXd> points);
  [[nodiscard]] SearchEvaluation evaluated(const Eigen::VectorXd& x) const;

  BlackBoxProblem problem_;
  std::size_t max_evaluations_;
  Progress* progress_;
  SearchLog log_;
  std::size_t used_ = 0, failed_ = 0;
  SearchTermination ended_ = SearchTermination::kEvaluations;
  std::map<std::vector<double>, std::size_t> known_;  ///< evaluation by point
};

}  // namespace veridyn::estimation
