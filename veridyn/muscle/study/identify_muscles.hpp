#pragma once

#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/logged_model.hpp"
#include "veridyn/estimation/result/analysis.hpp"
#include "veridyn/estimation/uncertainty/posterior_sampling.hpp"
#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"
#include "veridyn/muscle/identification/task_advice.hpp"
#include "veridyn/muscle/identification/task_judgement.hpp"
#include "veridyn/muscle/study/task_study.hpp"
#include "veridyn/numerics/batches/value_log.hpp"
#include "veridyn/numerics/ranks/ranks.hpp"

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
  Eigen::VectorXd moment_noise = {};   ///< of the outputs, as stated or as found together with the EMG's error
  std::vector<double> emg_share = {};  ///< by trained task: share of the residual's variance that is the EMG's error
  Eigen::VectorXd emg_error_factors = {};  ///< as `EmgEstimate`
  double preparing_s = 0.0;                ///< computed muscle control of the tasks
  /// What the search asked of the trained tasks: misfit is the NRMSE of `task_error`.
  std::vector<estimation::ModelEvaluation> evaluations = {};
  std::size_t resumed = 0;  ///< simulations that were answered from the log of an earlier run
};

/// The full pipeline: tasks prepared, measured (or a person simulated), estimate from those that are not held out,
/// hold-out, verdict.
/// @param log  keeps what search, profiles and posterior ask of the model, so that a run which was cut off goes on to
/// the same bits; of this study alone. nullptr: nothing is kept. The published search keeps its own log in the same
/// folder, `search.csv`, where the study names none
/// @param ranks  whose processes all call this function with the same study: the first comes to the result, on any
/// number of them to the same bits; the others simulate for it, and return an empty analysis
/// @throws InputError when no task can be estimated from, std::runtime_error when every search diverges, naming task,
/// time and state.
[[nodiscard]] MuscleAnalysis identify(const TaskStudy& study, Progress& progress, numerics::ValueLog* log = nullptr,
                                      const numerics::Ranks& ranks = {});

/// An estimate on the tasks of a study, all of them unseen. @throws InputError when it names no unknown of the study.
[[nodiscard]] MuscleAnalysis validate(const TaskStudy& study, const estimation::Estimate& estimate, Progress& progress);

}  // namespace veridyn::muscle
