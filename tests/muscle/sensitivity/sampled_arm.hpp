#pragma once

#include <utility>
#include <vector>

#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/sensitivity/muscle_sensitivity.hpp"
#include "veridyn/muscle/tasks/elbow_tasks.hpp"

namespace veridyn::muscle::test {

/// The built-in arm with some of the 42 tasks.
struct SampledArm {
  explicit SampledArm(const std::vector<int>& numbers)
      : arm(load_model("arm").model(), {.paths = PathSource::kFitted}) {
    std::vector<Task> list;
    for (const int n : numbers) list.push_back(make_elbow_task(arm.model(), resolved(arm.model(), {}), n));
    Progress progress;
    tasks = prepare_tasks(arm, std::move(list), progress);
  }
  MusculoskeletalSystem arm;
  std::vector<PreparedTask> tasks;
};

inline const SampledArm& four_tasks() {
  static const SampledArm sampled({8, 11, 29, 33});
  return sampled;
}

/// Few simulations.
inline SensitivityStudyOptions small_study() {
  SensitivityStudyOptions options;
  options.sampling.samples = 8;
  options.cover.tasks = 2;
  options.indices.method = IndexMethod::kMorris;
  options.indices.morris_trajectories = 2;
  return options;
}

}  // namespace veridyn::muscle::test
