#pragma once

#include <string>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/identification/task_estimate.hpp"
#include "veridyn/muscle/tasks/task_error.hpp"

namespace veridyn::muscle {

/// A task as it was measured and as models predict it.
struct TaskOutcome {
  std::string name;
  bool hold_out = false;
  std::vector<double> time = {};                        ///< [s]
  estimation::RowMatrix measured = {};                  ///< samples x outputs
  estimation::RowMatrix standard = {}, estimated = {};  ///< predictions; empty: the simulation cannot finish
  TaskError before = {}, after = {};                    ///< of these two
  double reserve_share = 0.0;                           ///< as `PreparedTask`
};

/// View of what an estimate from tasks is judged by.
struct TaskFindings {
  const TaskEstimate& estimate;
  const std::vector<TaskOutcome>& tasks;          ///< trained ones, then those held out
  const std::vector<std::string>& unused;         ///< tasks that could not be set up, with why
  const std::vector<std::string>& wrap_warnings;  ///< `task_warnings`
  bool noise_known = false;
  double noise = 0.0;         ///< of the first output
  bool simulated = false;     ///< the recording is a simulated person's
  bool along_angles = false;  ///< muscles along recorded angles, driven by EMG
};

/// The rows, one function a check: residual against the noise, its correlation, unseen tasks against the standard model
/// and the noise, bounds, searches that agree, distance from the standard model, what is determined at all, tasks,
/// wraps, reserves, what is taken as given.
[[nodiscard]] std::vector<estimation::Evidence> judge_tasks(const TaskFindings& findings);

/// Tasks that no estimate saw against the noise and the standard model.
[[nodiscard]] std::vector<estimation::Evidence> judge_hold_out(const std::vector<TaskOutcome>& tasks, double noise,
                                                               double trained_rmse);

}  // namespace veridyn::muscle
