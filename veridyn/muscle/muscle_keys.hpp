#pragma once

#include <vector>

#include "veridyn/core/study_keys.hpp"

namespace veridyn::muscle {

/// The keys of the tables of a muscle study, in the order in which one writes them.
[[nodiscard]] std::vector<StudyKeys> study_keys();

}  // namespace veridyn::muscle
