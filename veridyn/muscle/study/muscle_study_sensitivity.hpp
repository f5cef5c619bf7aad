#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/muscle/sensitivity/muscle_sensitivity.hpp"
#include "veridyn/muscle/study/muscle_subject.hpp"
#include "veridyn/muscle/tasks/task.hpp"

namespace veridyn::muscle {

/// A study of which muscle moves which task, read and checked.
struct SensitivityStudy {
  std::string title;
  MuscleSubject subject;
  std::vector<Task> tasks;
  SensitivityStudyOptions options;
  std::uint64_t seed = 1;
  std::vector<std::string> notes;             ///< tasks that the model cannot perform, or that are held out
  std::vector<std::filesystem::path> inputs;  ///< files read
};

/// Reads `[subject]`, `[tasks]`, `[[task]]` (`read_tasks`), `[[parameter]]` (`read_unknowns`: inputs of the indices;
/// F0, L0 and LS of each muscle when there is none) and
///
///     [sensitivity]
///     samples = 512          # points of the Sobol sequence for each muscle; published: 500
///     range = "5 %"          # by which F0, L0 and LS of a muscle go up and down
///     scrambled = true       # random digital shift of the sequence; false: as it is, as published
///     choose = 4             # tasks; 0: as few as excite every muscle
///     cover_share = "50 %"   # a task excites a muscle with this share of the greatest NRMSE that any task has of it
///     least_nrmse = 1e-3     # below it in every task a muscle counts as not excited
///     method = "variance"    # first and total indices of the chosen tasks; "morris"; "none"
///     index_samples = 512    # N of N (inputs + 2) points; a power of two is best
///     replicates = 16        # independent parts of these samples, whose spread makes the intervals
///     level = 0.95           # of these intervals
///     trajectories = 20      # of Morris
///     levels = 4             # of Morris' grid
///     accuracy = 1e-5        # of the simulations
///
/// Tables of other commands are left as they are. Tasks that are held out stay for validation and are not looked at.
/// @throws InputError with file, line and key.
[[nodiscard]] SensitivityStudy read_sensitivity_study(const Study& study, Progress& progress);

}  // namespace veridyn::muscle
