#pragma once

#include <vector>

#include "veridyn/core/study_keys.hpp"

namespace veridyn::camera {

/// The keys of the tables of `veridyn camera` and of a study's `[live.camera]`.
[[nodiscard]] std::vector<StudyKeys> study_keys();

}  // namespace veridyn::camera
