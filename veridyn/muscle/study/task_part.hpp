#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "veridyn/estimation/output_error/logged_model.hpp"
#include "veridyn/estimation/output_error/shared_model.hpp"
#include "veridyn/muscle/identification/emg_driven_model.hpp"
#include "veridyn/muscle/identification/muscle_parametric_model.hpp"
#include "veridyn/muscle/study/task_recordings.hpp"
#include "veridyn/muscle/study/task_study.hpp"

namespace veridyn::muscle {

/// The tasks of one use, to estimate from or held out, and the model that estimators see of them; views the recordings.
struct TaskPart {
  std::vector<const TaskRecording*> tasks;
  std::vector<estimation::RowMatrix> measured;
  // One of them: tasks that are simulated forward, or along their recorded angles.
  std::unique_ptr<MuscleParametricModel> forward;
  std::unique_ptr<EmgDrivenModel> along;

  [[nodiscard]] const estimation::ParametricModel& model() const {
    if (along) return *along;
    return *forward;
  }
};

/// How the study's tasks are simulated forward.
[[nodiscard]] MuscleModelOptions model_options(const TaskStudy& study);

/// The recordings with `hold_out` as given; without a model where there are none.
[[nodiscard]] TaskPart task_part(const TaskStudy& study, const TaskRecordings& all, bool hold_out);

/// Of what simulations of the part follow from: all processes that share them must have the same.
[[nodiscard]] std::uint64_t fingerprint_of(const TaskStudy& study, const TaskPart& part);

/// Views of the trained tasks as a search sees them: simulated by all processes of a work, answered from the log as far
/// as it goes.
struct SearchedTasks {
  SearchedTasks(const TaskPart& trained, numerics::SharedWork& work, numerics::ValueLog* log);

  const TaskPart* part;
  estimation::SharedModel shared;
  estimation::LoggedModel logged;
};

}  // namespace veridyn::muscle
