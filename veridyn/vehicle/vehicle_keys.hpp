#pragma once

#include <vector>

#include "veridyn/core/study_keys.hpp"

namespace veridyn::vehicle {

/// The keys of the tables of a vehicle's study, in the order in which one writes them.
[[nodiscard]] std::vector<StudyKeys> study_keys();

}  // namespace veridyn::vehicle
