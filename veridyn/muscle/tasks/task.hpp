#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/model/signals.hpp"
#include "veridyn/muscle/simulation/computed_muscle_control.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// A coordinate that a task locks.
struct HeldCoordinate {
  int coordinate = 0;
  double value = 0.0;  ///< [rad] or [m]
};

/// A recorded motion: what a model's outputs are compared with.
struct MeasuredMotion {
  std::vector<double> time;      ///< [s]; at the first the simulation starts
  estimation::RowMatrix values;  ///< samples x outputs of the study; NaN: not measured [SI]
  std::string source;            ///< file
};

/// A motion recorded with EMG: angles, envelopes and what inverse dynamics found, each with its own times on one clock.
struct EmgRecording {
  Motion angles;
  Eigen::VectorXd rest;             ///< values of the coordinates that `angles` does not have [rad or m]
  std::vector<ControlSignals> emg;  ///< by signal: one envelope each, 0 to 1
  double begin = 0.0;               ///< angles and EMG begin [s]
  std::vector<double> time;         ///< of the values that are compared [s]
  estimation::RowMatrix measured;   ///< samples x outputs of the study; NaN: not measured [SI]
};

/// A motion that a person performs for an estimate of the muscles: what is desired, what is held, what is carried.
struct Task {
  std::string name;
  int number = 0;                         ///< of the 42 elbow tasks; 0: the study's own
  std::vector<HeldCoordinate> held = {};  ///< besides what the subject locks
  std::vector<HeldLoad> loads = {};       ///< besides the subject's
  double begin = 0.0, end = 1.03;         ///< [s]
  double rate_Hz = 100.0;                 ///< of the samples, where nothing is measured
  /// Every coordinate that is not coupled: the motion that computed muscle control follows, and the pose at the start.
  Motion desired = {};
  ControlOptions control = {};  ///< its times are those above
  /// The controls with which it was performed; none: those with which the standard model follows the desired motion.
  std::optional<MuscleControls> controls = {};
  std::optional<MeasuredMotion> measured = {};
  /// Muscles follow recorded angles instead of moving a skeleton.
  std::optional<EmgRecording> recording = {};
  bool hold_out = false;  ///< for validation: no estimate sees it
};

/// A task, ready to be simulated with any muscles: its system, controls and start.
struct PreparedTask {
  Task task;
  /// The standard model in this task: with its load, its held coordinates. Fitted paths are shared between tasks.
  std::shared_ptr<const MusculoskeletalSystem> system;
  StartState start;
  MuscleControls controls;
  std::vector<double> time;  ///< of its samples [s]; the first is where it starts
  std::string trouble;       ///< why it cannot be used, with the time; empty: it can
  double tracking_error =
      0.0;  ///< of the standard model from the desired motion, largest of any free coordinate [rad or m]
  std::size_t overloaded = 0;  ///< windows of computed muscle control in which reserves exceeded their force
  double reserve_share = 0.0;  ///< largest reserve over largest muscle moment, of the free coordinates

  [[nodiscard]] bool usable() const { return trouble.empty(); }
};

/// Share of the muscles' moment that reserves may add: beyond, it is not the muscles that move the task.
inline constexpr double kMostReserveShare = 0.2;

/// Gives each task its system (`subject` with the task's load and locks), its controls and its start. Controls are
/// those of computed muscle control of the subject's muscles where the task brings none. On the progress' threads; the
/// same bits on any number of them. A task whose control does not finish is returned with its trouble.
/// @throws InputError for a task that cannot be set up: every free coordinate held, a value outside its range.
[[nodiscard]] std::vector<PreparedTask> prepare_tasks(const MusculoskeletalSystem& subject, std::vector<Task> tasks,
                                                      Progress& progress);

}  // namespace veridyn::muscle
