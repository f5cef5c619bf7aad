#pragma once

#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/muscle/identification/emg_driven_model.hpp"
#include "veridyn/muscle/identification/task_judgement.hpp"

namespace veridyn::muscle {

/// View of what an estimate from EMG is judged by besides `TaskFindings`.
struct EmgFindings {
  const EmgDrivenModel& model;  ///< of the trained tasks
  const MusculoskeletalSystem& system;
  const Eigen::VectorXd& theta;           ///< the estimate
  const std::vector<TaskOutcome>& tasks;  ///< trained ones, then those held out
  const EmgError& error;                  ///< as stated
  const Eigen::VectorXd& error_factors;   ///< as `EmgEstimate`
  const std::vector<MuscleOutput>& outputs;
};

/// The rows that only recordings with EMG have: the sign of the moments, what of them the muscles explain, excitations
/// beyond the maximum, what is stated of the EMG's error, and its size as the moments ask for it.
[[nodiscard]] std::vector<estimation::Evidence> judge_emg(const EmgFindings& findings);

}  // namespace veridyn::muscle
