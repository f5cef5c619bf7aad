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

/// `[sensitivity]`.
[[nodiscard]] const KeyTable<SensitivityStudyOptions>& sensitivity_keys();

/// Reads `[subject]`, `[tasks]`, `[[task]]` (`read_tasks`), `[[parameter]]` (`read_unknowns`: inputs of the indices;
/// F0, L0 and LS of each muscle when there is none) and `[sensitivity]` (also `estimation::read_index_options`).
/// Tables of other commands are left as they are. Tasks that are held out stay for validation and are not looked at.
/// @throws InputError with file, line and key.
[[nodiscard]] SensitivityStudy read_sensitivity_study(const Study& study, Progress& progress);

}  // namespace veridyn::muscle
