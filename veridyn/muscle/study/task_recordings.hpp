#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/muscle/identification/emg_driven_model.hpp"
#include "veridyn/muscle/identification/muscle_parametric_model.hpp"
#include "veridyn/muscle/study/task_study.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle {

/// A task with what was measured of it, as estimators see it: to be simulated forward, or along its recorded angles.
struct TaskRecording {
  std::string name;
  bool hold_out = false;
  double reserve_share = 0.0;      ///< as `PreparedTask`
  std::vector<double> time;        ///< of the samples [s]
  estimation::RowMatrix measured;  ///< samples x outputs of the study; NaN: not measured
  std::optional<MotionSegment> forward = {};
  std::optional<EmgSegment> along = {};
  estimation::RowMatrix q = {};  ///< recorded angles at the samples, all coordinates; empty where simulated forward
  std::shared_ptr<const MusculoskeletalSystem> system = {};  ///< of `forward`
};

/// The tasks of a study, those that can be used.
struct TaskRecordings {
  std::vector<TaskRecording> tasks;
  std::vector<std::string> unused;                   ///< those that could not be set up, with why
  std::map<std::string, double, std::less<>> truth;  ///< hidden values of a simulated person, by unknown
  double seconds = 0.0;
};

/// Sets up the tasks of a study: controls by computed muscle control where it brings none, recordings as they are, or a
/// simulated person's. With `[emg]` the person follows the desired motions with the controls that its own muscles need;
/// what is recorded are the angles that come out, the muscles' moments, and as EMG the controls, smoothed to the
/// envelope's bandwidth, in units of the hidden gain and ahead by the hidden delay, all with noise.
[[nodiscard]] TaskRecordings task_recordings(const TaskStudy& study, Progress& progress);

/// The start of every unknown.
[[nodiscard]] Eigen::VectorXd start_values(const std::vector<MuscleUnknown>& unknowns);

namespace internal {

/// Noise of a simulated recording with standard deviation 1: stationary, of first order (correlation
/// exp(-dt/correlation_s) of samples dt apart), white where the correlation time is 0.
class RecordingNoise {
 public:
  explicit RecordingNoise(double correlation_s) : correlation_s_(correlation_s) {}
  /// At the next sample [s].
  [[nodiscard]] double next(double time, numerics::RandomStream& random);

 private:
  double correlation_s_, value_ = 0.0, time_ = 0.0;
  bool first_ = true;
};

/// Hidden values of a simulated person, unknown by unknown, delays within half of the way to their bounds.
[[nodiscard]] Eigen::VectorXd hidden_values(const TaskStudy& study);
/// A person's system in a task: true muscles (of the class that the study says, before hidden values) and loads along
/// the model's paths.
[[nodiscard]] std::shared_ptr<const MusculoskeletalSystem> person_system(const TaskStudy& study, const Task& task);
/// `task_recordings` of a study with `[emg]`.
[[nodiscard]] TaskRecordings emg_task_recordings(const TaskStudy& study, Progress& progress);

}  // namespace internal

}  // namespace veridyn::muscle
