#pragma once

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/muscle/study/motion_study.hpp"

namespace veridyn::muscle {

/// A muscle study is one whose `[subject]` names a `model`.
[[nodiscard]] bool is_muscle_study(const StudyTable& root);

/// Reads a study: `[subject]` and `[motion]`, with the keys of `veridyn keys muscle` (`study_keys`).
/// @throws InputError with file, line and key, of keys too that no study of muscles has.
[[nodiscard]] MuscleStudy read_study(const Study& study, Progress& progress);

}  // namespace veridyn::muscle
