#pragma once

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/output_error_problem.hpp"

namespace veridyn::estimation::internal {

/// View of one segment of a problem, whose triangle it hands to Ceres.
class SegmentCost : public ceres::CostFunction {
 public:
  SegmentCost(const OutputErrorProblem& problem, std::size_t segment) : problem_(problem), segment_(segment) {
    set_num_residuals(static_cast<int>(problem.unknowns(segment)) + 1);
    if (problem.local_count(segment) > 0)
      mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.local_count(segment)));
    if (problem.shared_count() > 0)
      mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.shared_count()));
  }
  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const internal::SegmentTriangle& t = problem_.triangle(segment_);
    if (!t.valid) return false;
    const Eigen::Index rows = problem_.unknowns(segment_) + 1, locals = problem_.local_count(segment_);
    Eigen::Map<Eigen::VectorXd> r(residuals, rows);
    if (jacobians == nullptr) {
      r.setZero();
      r(0) = std::sqrt(t.squares);
      return true;
    }
    r = t.matrix.rightCols(1);
    std::size_t block = 0;
    for (const auto& [first, count] :
         {std::pair{Eigen::Index{0}, locals}, std::pair{locals, problem_.shared_count()}}) {
      if (count == 0) continue;
      if (jacobians[block] != nullptr)
        Eigen::Map<RowMatrix>(jacobians[block], rows, count) = t.matrix.middleCols(first, count);
      ++block;
    }
    return true;
  }

 private:
  const OutputErrorProblem& problem_;
  std::size_t segment_;
};

/// (x - start) / sigma of unknowns with a prior; zero rows for the others.
class PriorCost : public ceres::CostFunction {
 public:
  PriorCost(Eigen::VectorXd start, Eigen::VectorXd precision_root)
      : start_(std::move(start)), root_(std::move(precision_root)) {
    set_num_residuals(static_cast<int>(start_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(start_.size()));
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const Eigen::Index n = start_.size();
    for (Eigen::Index i = 0; i < n; ++i) residuals[i] = root_(i) > 0.0 ? root_(i) * (x[0][i] - start_(i)) : 0.0;
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<RowMatrix>(jacobians[0], n, n) = RowMatrix(root_.asDiagonal());
    return true;
  }

 private:
  Eigen::VectorXd start_, root_;
};

/// View of a problem that evaluates all segments at once, on our threads and in a fixed order: Ceres itself runs on
/// one.
class EvaluateSegments : public ceres::EvaluationCallback {
 public:
  explicit EvaluateSegments(OutputErrorProblem& problem) : problem_(problem) {}
  void PrepareForEvaluation(bool evaluate_jacobians, bool) override { problem_.evaluate(evaluate_jacobians); }

 private:
  OutputErrorProblem& problem_;
};

/// View of the caller's progress and of a problem: Ceres stops when it is interrupted, or where an unknown is pressed
/// on a bound that it was free to leave. With a step that points beyond a bound Ceres searches along the line in vain,
/// each time by twenty simulations.
class Watch : public ceres::IterationCallback {
 public:
  Watch(Progress& progress, const OutputErrorProblem& problem, const std::vector<int>& held)
      : progress_(progress), problem_(problem), held_(held) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    if (iteration.iteration > 0 && iteration.step_is_successful) ++accepted_steps_;
    // Where it stands is as good an end as any other.
    interrupted_ = progress_.interrupted();
    if (interrupted_) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    if (iteration.iteration == 0 || !iteration.step_is_successful) return ceres::SOLVER_CONTINUE;
    meets_bound_ = !std::ranges::includes(held_, problem_.pressed_on_bounds());
    return meets_bound_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
  [[nodiscard]] bool meets_bound() const { return meets_bound_; }
  [[nodiscard]] bool interrupted() const { return interrupted_; }
  [[nodiscard]] int accepted_steps() const { return accepted_steps_; }

 private:
  Progress& progress_;
  const OutputErrorProblem& problem_;
  const std::vector<int>& held_;
  bool meets_bound_ = false;
  bool interrupted_ = false;
  int accepted_steps_ = 0;
};

}  // namespace veridyn::estimation::internal
