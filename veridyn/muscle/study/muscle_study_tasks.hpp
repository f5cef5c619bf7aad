#pragma once

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

/// Motions from which muscles are estimated:
///
///     [tasks]                        # what they share, and the 42 elbow tasks of the published method (`elbow_task`)
///     numbers = [5, 12, 26, 33]      # of the 42; "all": those that the coordinates' ranges allow
///     hold_out = [8, 30]             # further ones, for validation
///     elbow = "r_elbow_flex"         # moves; when left out the only coordinate with "elbow" in its name
///     shoulder = "r_shoulder_elev"   # is held; when left out the only one with "shoulder" in its name
///     load = 1.0                     # in the hand [kg]; 0: none; when left out 1, or 0 where the subject has loads
///     load_body = "r_ulna_radius_hand"  # when left out the body that the elbow moves
///     load_location = [0, -0.31, 0.08]  # when left out twice as far as its mass centre: the end of a uniform rod
///     start = 0.03                   # at rest before the movement [s]
///     duration = 1                   # of the movement [s]
///     rate = 100                     # of samples, where nothing is measured [Hz]
///     accuracy = 1e-6                # of simulations
///     reserve_force = 1              # as in [motion]
///     [tasks.control]                # as [motion.control]
///     window = 0.010
///
///     [[task]]                       # the study's own
///     name = "curl"
///     hold_out = false
///     duration = 1.1                 # [s]; to the end of the ramps or of the file when left out
///     file = "lift.mot"              # the desired motion; `low_pass` as in [motion]
///     [[task.ramp]]                  # as [[motion.ramp]]
///     coordinate = "r_elbow_flex"
///     to = "110 deg"
///     [task.held]                    # coordinates that are locked, and where
///     r_shoulder_elev = "30 deg"
///     [[task.load]]                  # as [[subject.load]], besides those
///     [task.start]                   # pose of coordinates that neither move nor are held; the model's when left out
///     measured = "trial.mot"         # the recorded outputs: .mot, .sto or .csv
///     excitation_file = "controls.sto"  # the controls with which it was performed; `interpolation` as in [motion].
///                                    # Without them: those with which the standard model follows the desired motion
///
/// With `emg`, of a study with `[emg]`, recorded tasks are those of `read_emg_recording`, with `held` and `start` for
/// coordinates that their files do not have.
/// @throws InputError with file, line and key: unknown names (with the nearest), every coordinate held, two tasks of
/// one name, a recording with gaps, without motion, shorter than two samples, beyond the controls, in degrees where
/// radians are said; no tasks at all.
[[nodiscard]] StudyTasks read_tasks(const StudyTable& root, const MuscleSubject& subject,
                                    std::span<const MuscleOutput> outputs, const EmgSettings* emg = nullptr);

}  // namespace veridyn::muscle
