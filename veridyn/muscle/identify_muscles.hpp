#pragma once

#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/analysis.hpp"
#include "veridyn/estimation/uncertainty/posterior_sampling.hpp"
#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"
#include "veridyn/muscle/identification/task_advice.hpp"
#include "veridyn/muscle/identification/task_judgement.hpp"
#include "veridyn/muscle/task_study.hpp"

namespace veridyn::muscle {

/// What identification or validation made of a person's tasks.
struct MuscleAnalysis : estimation::Analysis {
  TaskEstimate result;              ///< empty of a validation
  std::vector<TaskOutcome> tasks;   ///< trained ones, then those held out
  std::vector<std::string> unused;  ///< tasks that could not be set up, with why
  std::vector<estimation::ModelOutput> outputs;
  Model identified;  ///< the file's model with what was estimated; the file's own where the estimate is rejected
  estimation::ProfileResult profiles;     ///< those that the study asks for
  estimation::PosteriorSample posterior;  ///< where the study asks for it
  TaskAdvice advice;                      ///< empty where the study asks for none
  // Of recordings with EMG:
  Eigen::VectorXd moment_noise = {};   ///< of the outputs, as stated or as found beside the EMG's error
  std::vector<double> emg_share = {};  ///< by trained task: share of the residual's variance that is the EMG's error
  double preparing_s = 0.0;            ///< computed muscle control of the tasks
};

/// The full pipeline: tasks prepared, measured (or a person simulated), estimate from those that are not held out,
/// hold-out, verdict.
/// @throws InputError when no task can be estimated from, std::runtime_error when every search diverges, naming task,
/// time and state.
[[nodiscard]] MuscleAnalysis identify(const TaskStudy& study, Progress& progress);

/// An estimate on the tasks of a study, all of them unseen. @throws InputError when it names no unknown of the study.
[[nodiscard]] MuscleAnalysis validate(const TaskStudy& study, const estimation::Estimate& estimate, Progress& progress);

}  // namespace veridyn::muscle
