#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/muscle/sensitivity/muscle_sampling.hpp"
#include "veridyn/muscle/sensitivity/task_cover.hpp"
#include "veridyn/muscle/sensitivity/task_indices.hpp"

namespace veridyn::muscle {

/// What an analysis of sensitivity computes.
struct SensitivityStudyOptions {
  MuscleSamplingOptions sampling = {};
  CoverOptions cover = {};
  TaskIndexOptions indices = {};
  /// Inputs of the indices; empty: F0, L0 and LS of each muscle within the sampling's range.
  std::vector<MuscleUnknown> inputs = {};

  /// @throws InputError naming option, value and rule.
  void validate() const;
};

/// A task as the choice sees it.
struct TaskFinding {
  std::string name;
  int number = 0;                            ///< of the 42 elbow tasks; 0: the study's own
  std::string obstacle = {};                 ///< why it is not to be chosen; empty: it may be
  std::vector<std::string> wrap_bands = {};  ///< sentences: side changes, ends of cylinders on the standard motion
  std::size_t failed = 0;                    ///< simulations of the sampling that could not finish
};

/// What came out.
struct MuscleSensitivity {
  std::vector<std::string> muscles;
  std::vector<TaskFinding> tasks;
  MuscleSampling sampling;
  TaskCover cover;
  /// Tasks that pass such a pose could be chosen too, since without them a muscle is excited by none.
  bool bands_allowed = false;
  TaskIndices indices;
  std::vector<std::string> warnings;
  bool completed = true;  ///< false: interrupted, or the store lacks blocks; what is here is not complete

  [[nodiscard]] bool usable() const { return completed && cover.chosen.has_value(); }
};

/// The published sampling of every muscle in every task, the choice of tasks from it, and the indices of those chosen.
/// Simulations that cannot finish are counted and end nothing. The same bits on any number of threads.
/// @param store  where batches "sampling" and "indices" are kept; which simulations are in the second of them follows
///               from the first
/// @throws InputError when an option is out of order; what `BlockStore::compute` throws.
[[nodiscard]] MuscleSensitivity analyse_sensitivity(const MusculoskeletalSystem& subject,
                                                    std::span<const PreparedTask> tasks,
                                                    const SensitivityStudyOptions& options, numerics::BlockStore& store,
                                                    Progress& progress);
/// The same, and nothing is kept.
[[nodiscard]] MuscleSensitivity analyse_sensitivity(const MusculoskeletalSystem& subject,
                                                    std::span<const PreparedTask> tasks,
                                                    const SensitivityStudyOptions& options, Progress& progress);

}  // namespace veridyn::muscle
