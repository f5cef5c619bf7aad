#pragma once

#include <vector>

#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

/// The keys of the tables of an aircraft's study, in the order in which one writes them.
[[nodiscard]] std::vector<StudyKeys> study_keys();
/// Of a study of swing tests.
[[nodiscard]] std::vector<StudyKeys> swing_test_keys();
/// Of a study that calibrates the sensors of air data.
[[nodiscard]] std::vector<StudyKeys> calibration_keys();

}  // namespace veridyn::aircraft
