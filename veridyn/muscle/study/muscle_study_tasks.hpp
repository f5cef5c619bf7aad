#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/muscle/identification/muscle_outputs.hpp"
#include "veridyn/muscle/study/muscle_study_emg.hpp"
#include "veridyn/muscle/study/muscle_subject.hpp"
#include "veridyn/muscle/tasks/elbow_tasks.hpp"
#include "veridyn/muscle/tasks/task.hpp"

namespace veridyn::muscle {

/// The tasks of a study.
struct StudyTasks {
  std::vector<Task> tasks;
  double accuracy = 1e-6;          ///< of their simulations, as `[motion] accuracy`
  std::vector<std::string> notes;  ///< elbow tasks that the model cannot perform
  std::vector<std::filesystem::path> inputs;
  /// What the elbow tasks share, used or not; none where the model has no such tasks, for which `no_elbow` says why.
  std::optional<ElbowTaskOptions> elbow;
  std::string no_elbow;
};

/// `[tasks]`: what the tasks share.
struct TasksTable {
  ElbowTaskOptions elbow;
  std::optional<double> load;  ///< in the hand [kg]
  double accuracy = StudyTasks{}.accuracy;
  double reserve_force = 1.0;  ///< [N m or N]

  [[nodiscard]] static const KeyTable<TasksTable>& keys();
};

/// `[[task]]` as it is written.
struct TaskTable {
  std::string name;
  bool hold_out = false;
  std::optional<double> duration;  ///< [s]
  std::optional<std::filesystem::path> file;
  std::optional<double> low_pass_Hz;  ///< of `file`
  std::optional<std::filesystem::path> measured, excitation_file;
  Interpolation interpolation = Interpolation::kLinear;

  [[nodiscard]] static const KeyTable<TaskTable>& keys();
};

/// `[tasks]` and `[[task]]`: motions from which muscles are estimated, those that the study names of the 42 elbow tasks
/// of the published method (`elbow_task`) and its own.
///
/// With `emg`, of a study with `[emg]`, recorded tasks are those of `read_emg_recording`, with `held` and `start` for
/// coordinates that their files do not have.
/// @throws InputError with file, line and key: unknown names (with the nearest), every coordinate held, two tasks of
/// one name, a recording with gaps, without motion, shorter than two samples, beyond the controls, in degrees where
/// radians are said; no tasks at all.
[[nodiscard]] StudyTasks read_tasks(const StudyTable& root, const MuscleSubject& subject,
                                    std::span<const MuscleOutput> outputs, const EmgSettings* emg = nullptr);

}  // namespace veridyn::muscle
