#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/muscle/identification/muscle_parametric_model.hpp"
#include "veridyn/muscle/identification/task_estimate.hpp"
#include "veridyn/muscle/tasks/elbow_tasks.hpp"

namespace veridyn::muscle {

/// The widest interval among the parameters of an estimate that count.
struct WidestInterval {
  std::string parameter;
  /// Half the width of the interval of 95 % over the standard model's value; of a parameter that may be zero (a delay),
  /// over half the width of its bounds.
  double share = 0.0;
};

/// A task that was not performed, and what it would leave of the widest interval.
struct AdvisedTask {
  int number = 0;  ///< of the 42 elbow tasks
  std::string name;
  WidestInterval then;
};

/// Which task to perform next.
struct TaskAdvice {
  WidestInterval now;
  /// Parameters that do not count: no single task would make them identified. Their intervals are so wide that
  /// sensitivities change within them, and a forecast of them would be one of the prior.
  std::vector<std::string> left_to_prior;
  /// All parameters are such: the widest of all counts, and the forecast is little more than the prior.
  bool of_prior = false;
  std::vector<AdvisedTask> tasks;     ///< all that could be performed, the best first
  std::vector<std::string> left_out;  ///< tasks that may not be advised, with why
  std::string withheld;               ///< why nothing is advised; empty: something is, or the study asks for none
  double seconds = 0.0;

  /// "the widest interval, A's, would go from +-12 to 4 %", with what that is worth.
  [[nodiscard]] std::string text() const;
};

/// The elbow tasks that `used` (numbers) does not name and that the model can perform, with the controls with which the
/// standard model follows them; what is left out is named in `left_out`: how many are outside the model's ranges, a
/// control that does not finish, reserves beyond `kMostReserveShare`.
[[nodiscard]] std::vector<PreparedTask> candidate_tasks(const MusculoskeletalSystem& subject,
                                                        const ElbowTaskOptions& options, std::span<const int> used,
                                                        std::vector<std::string>& left_out, Progress& progress);

/// What each candidate would add to an estimate: the information of its exact sensitivities at the estimate, under the
/// outputs, the noise and the unknown starts of the estimate, on top of that behind the estimate's intervals
/// (`estimation::covariance_after`). What counts is the widest interval of the parameters that are identified, or
/// would be with one task more (three quarters of the prior's variance gone). Corrections of the intervals for
/// correlation and size of the residual are taken to stay as they are, parameters at their bound are left out.
/// Candidates that pass a side change or a cylinder's end, with the standard model's parameters or the estimate's, are
/// not advised. On the progress' threads, the same bits on any number of them.
/// @param options of `model`
[[nodiscard]] TaskAdvice advise_task(const MusculoskeletalSystem& subject, const MuscleParametricModel& model,
                                     const MuscleModelOptions& options, const TaskEstimate& estimate,
                                     std::span<const PreparedTask> candidates, Progress& progress);

}  // namespace veridyn::muscle
