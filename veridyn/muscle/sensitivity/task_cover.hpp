#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace veridyn::muscle {

/// How tasks are chosen that together excite every muscle.
struct CoverOptions {
  std::size_t tasks = 4;  ///< in a choice, as published; 0: as few as excite every muscle
  /// A task excites a muscle when its NRMSE is at least this share of the greatest that any allowed task has of it.
  double share = 0.5;
  /// Below it a muscle counts as excited by no task: parameters 5 % off then move it by less than what a motion capture
  /// system resolves (0.1 deg of 90).
  double least_nrmse = 1e-3;

  /// @throws InputError naming option, value and rule.
  void validate() const;
};

/// Some tasks, and how well they excite the muscles together.
struct TaskSet {
  std::vector<std::size_t> tasks;  ///< increasing
  std::size_t excited = 0;         ///< muscles
  /// NRMSE as shares of the greatest that any allowed task has of the muscle: in the task of the set that excites the
  /// muscle most, of the muscle that has least and the mean over muscles.
  double weakest = 0.0, mean = 0.0;
  double overall = 0.0;  ///< mean of the shares over all muscles and tasks of the set
  std::size_t weakest_muscle = 0;
};

/// Which tasks to perform.
struct TaskCover {
  std::optional<TaskSet> chosen;                  ///< none: no task is allowed
  std::optional<TaskSet> runner_up;               ///< of as many tasks; none: there is only one such set
  std::vector<std::vector<std::size_t>> excites;  ///< muscles, by task; of tasks that are not allowed too
  std::vector<double> greatest;                   ///< NRMSE by muscle in any allowed task
  std::vector<std::size_t> unexcited;             ///< muscles that no allowed task moves: they count for nothing
  std::size_t missed = 0;                         ///< muscles that some task excites but none of those chosen
  /// All sets were compared. Else (more than two million of them) they were built task by task, and each exchange of
  /// one task was tried until none was better.
  bool exhaustive = true;
};

/// Chooses tasks by set cover: of all sets of so many allowed tasks the one that excites most muscles; of several the
/// one whose weakest muscle is excited most, then the one with the greatest mean, then with the greatest overall mean
/// (where one task of the set has the most of every muscle, the others still count); the first in order of equal ones.
/// @param nrmse    muscles x tasks: what changed parameters of a muscle do to a task; NaN counts as 0
/// @param allowed  by task
[[nodiscard]] TaskCover choose_tasks(const Eigen::MatrixXd& nrmse, const std::vector<bool>& allowed,
                                     const CoverOptions& options = {});

}  // namespace veridyn::muscle
