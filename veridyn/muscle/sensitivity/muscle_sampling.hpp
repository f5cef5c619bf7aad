#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/muscle/sensitivity/task_responses.hpp"

namespace veridyn::muscle {

/// How the parameters of a muscle are varied.
struct MuscleSamplingOptions {
  std::size_t samples = 512;  ///< of each muscle
  double range = 0.05;        ///< share by which F0, L0 and LS go up and down
  bool scrambled = true;      ///< random digital shift of the Sobol sequence; published: none
  double accuracy = 1e-5;     ///< of the simulations
  std::uint64_t seed = 1;
};

/// What each muscle's parameters do to each task: muscles x tasks. NRMSE from the standard model's motion over the
/// points that could be simulated; NaN: none could, or the task's motion is less than 1 deg.
struct MuscleSampling {
  Eigen::MatrixXd mean, sd, greatest;
  Eigen::MatrixXi failed;  ///< simulations that could not finish
  std::size_t samples = 0;
  std::size_t simulations = 0;
  double seconds = 0.0, processor_seconds = 0.0;
  bool completed = true;  ///< false: the progress asked to stop, or blocks of other processes are missing
};

/// F0, L0 and LS of a muscle as factors of the model's values, from 1 - range to 1 + range.
[[nodiscard]] std::vector<MuscleUnknown> muscle_factors(const Model& model, std::size_t muscle, double range);
/// The same of all muscles, one after the other.
[[nodiscard]] std::vector<MuscleUnknown> muscle_factors(const Model& model, double range);

/// The published sampling: points of a Sobol sequence in the F0, L0 and LS of one muscle, the same for each, while all
/// other muscles are as the model has them; in every task, under the controls of the standard model.
/// @param responses  of `muscle_factors` of all muscles
/// @param store      its batch is called "sampling"
[[nodiscard]] MuscleSampling sample_muscles(const TaskResponses& responses, const MuscleSamplingOptions& options,
                                            numerics::BlockStore& store, Progress& progress);

}  // namespace veridyn::muscle
