#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/muscle/identification/muscle_parametric_model.hpp"
#include "veridyn/muscle/tasks/task.hpp"

namespace veridyn::numerics {
class BlockStore;
}

namespace veridyn::muscle {

/// How far tasks move from the standard model's motion when its muscles are others, under the same controls: NRMSE as
/// a function of the unknowns. The tasks and the subject must outlive it.
class TaskResponses {
 public:
  /// Simulates the standard model's own motion of each task; of one that is not usable there is none.
  TaskResponses(const MusculoskeletalSystem& subject, std::vector<MuscleUnknown> unknowns,
                std::span<const PreparedTask> tasks, double accuracy);

  [[nodiscard]] std::span<const MuscleUnknown> unknowns() const { return model_->unknowns(); }
  [[nodiscard]] std::size_t tasks() const { return targets_.size(); }
  /// The standard model's motion: samples x free coordinates; empty: it could not be simulated, and nothing can.
  [[nodiscard]] const estimation::RowMatrix& target(std::size_t task) const { return targets_[task]; }
  /// Of the unknowns and of every bit of the standard model's motions, which follow from model, controls and accuracy.
  [[nodiscard]] std::uint64_t fingerprint() const;
  /// NaN: the simulation could not finish, or the target moves less than 1 deg.
  [[nodiscard]] double nrmse(std::size_t task, const Eigen::VectorXd& unknowns) const;

 private:
  std::unique_ptr<MuscleParametricModel> model_;
  std::vector<estimation::RowMatrix> targets_;
  std::vector<std::size_t> segment_;  ///< of the model, by task; of one that is not usable without meaning
};

/// NRMSE of many points in several tasks.
struct ResponseTable {
  Eigen::MatrixXd nrmse;  ///< points x tasks as asked for
  std::size_t simulations = 0;
  double processor_seconds = 0.0;  ///< of all threads, processes and earlier runs
  bool completed = true;           ///< false: the progress asked to stop, or the store lacks blocks of other processes
};

/// Simulates each of the tasks at each point, on the progress' threads; the same bits on any number of them.
/// @param points  a row each: values of the unknowns
/// @param store   what has been simulated before is taken from there
/// @param batch   what the store calls it
[[nodiscard]] ResponseTable respond(const TaskResponses& responses, const Eigen::MatrixXd& points,
                                    std::span<const std::size_t> tasks, numerics::BlockStore& store,
                                    const std::string& batch, Progress& progress);

}  // namespace veridyn::muscle
